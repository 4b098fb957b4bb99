// SPDX-License-Identifier: MIT
// Arrays of numbers in base64, little-endian whatever the machine.

function bytes_of(text: string): DataView {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) {
        bytes[i] = binary.charCodeAt(i);
    }
    return new DataView(bytes.buffer);
}

export function decode_f32(text: string): Float32Array {
    const view = bytes_of(text);
    const values = new Float32Array(view.byteLength >> 2);
    for (let i = 0; i < values.length; ++i) {
        values[i] = view.getFloat32(4 * i, true);
    }
    return values;
}

export function decode_u32(text: string): Uint32Array {
    const view = bytes_of(text);
    const values = new Uint32Array(view.byteLength >> 2);
    for (let i = 0; i < values.length; ++i) {
        values[i] = view.getUint32(4 * i, true);
    }
    return values;
}

export function decode_u16(text: string): Uint16Array {
    const view = bytes_of(text);
    const values = new Uint16Array(view.byteLength >> 1);
    for (let i = 0; i < values.length; ++i) {
        values[i] = view.getUint16(2 * i, true);
    }
    return values;
}
