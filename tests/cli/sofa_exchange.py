# SPDX-License-Identifier: MIT
"""SOFA files between earshot and other libraries: h5py, netCDF4 and libmysofa open what `earshot ir
--sofa` writes, with the samples of the WAV files, and earshot reads what h5py and netCDF4 write.

Arguments: the program, the folder of scenes. Exit status 77 where h5py, netCDF4 or libmysofa are
absent, which is told."""
import ctypes
import ctypes.util
import json
import os
import struct
import subprocess
import sys
import tempfile

try:
    import h5py
    import netCDF4
    import numpy as np
except ImportError as absent:
    print(f"skipped: {absent}; install python3-h5py and python3-netcdf4")
    sys.exit(77)
MYSOFA = ctypes.util.find_library("mysofa")
if MYSOFA is None:
    print("skipped: no libmysofa; install libmysofa1")
    sys.exit(77)

PROGRAM, SCENES = sys.argv[1:3]
EARS = np.array([[0.0, 0.09, 0.0], [0.0, -0.09, 0.0]])


def earshot(*arguments):
    run = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run


def wav_channels(path):
    """The channels of a WAV file of 32-bit floats."""
    data = open(path, "rb").read()
    assert data[:4] == b"RIFF" and data[8:12] == b"WAVE"
    position, channels, samples = 12, None, None
    while position + 8 <= len(data):
        kind, size = struct.unpack_from("<4sI", data, position)
        if kind == b"fmt ":
            channels = struct.unpack_from("<HH", data, position + 8)[1]
        if kind == b"data":
            samples = np.frombuffer(data, "<f4", size // 4, position + 8)
        position += 8 + size + size % 2
    return samples.reshape(-1, channels).T.astype(float)


class MysofaArray(ctypes.Structure):
    _fields_ = [("values", ctypes.POINTER(ctypes.c_float)),
                ("elements", ctypes.c_uint),
                ("attributes", ctypes.c_void_p)]


class MysofaHrtf(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint) for name in "ICRENM"] + [
        (name, MysofaArray)
        for name in ("ListenerPosition", "ReceiverPosition", "SourcePosition", "EmitterPosition",
                     "ListenerUp", "ListenerView", "DataIR", "DataSamplingRate", "DataDelay")]


def read_with_mysofa(path):
    library = ctypes.CDLL(MYSOFA)
    library.mysofa_load.restype = ctypes.POINTER(MysofaHrtf)
    fault = ctypes.c_int(0)
    sofa = library.mysofa_load(path.encode(), ctypes.byref(fault))
    assert sofa and fault.value == 0, f"libmysofa: {fault.value}"
    file = sofa.contents
    array = lambda a: np.array(a.values[:a.elements])
    return {"Data.IR": array(file.DataIR).reshape(file.M, file.R, file.N),
            "ReceiverPosition": array(file.ReceiverPosition).reshape(file.R, 3),
            "Data.SamplingRate": array(file.DataSamplingRate)}


def read_with_h5py(path):
    with h5py.File(path) as file:
        for name, data in file.items():
            if len(name) > 1:
                for dimension, scale in zip(data.shape, data.dims):
                    assert len(scale) == 1 and len(scale[0]) == dimension, name
        texts = {key: value.decode() if isinstance(value, bytes) else str(value)
                 for key, value in file.attrs.items()}
        receivers = file["ReceiverPosition"]
        return {"attributes": texts,
                "receiver type": receivers.attrs["Type"].decode(),
                "ReceiverPosition": receivers[:, :, 0],
                "Data.IR": file["Data.IR"][()],
                "Data.SamplingRate": file["Data.SamplingRate"][()]}


def read_with_netcdf4(path):
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        assert list(file.dimensions) == list("MRNECI"), list(file.dimensions)
        assert file["Data.IR"].dimensions == ("M", "R", "N")
        return {"attributes": {key: file.getncattr(key) for key in file.ncattrs()},
                "receiver type": file["ReceiverPosition"].Type,
                "ReceiverPosition": file["ReceiverPosition"][:, :, 0],
                "Data.IR": file["Data.IR"][:],
                "Data.SamplingRate": file["Data.SamplingRate"][:]}


def check_written(folder):
    scene = os.path.join(SCENES, "shoebox.gltf")
    for form, receiver_type, receivers in (("mono", "cartesian", np.zeros((1, 3))),
                                           ("binaural", "cartesian", EARS),
                                           ("ambisonic:2", "spherical harmonics", np.zeros((9, 3)))):
        out = os.path.join(folder, form.replace(":", "_"))
        ears = ["--hrtf", os.path.join(folder, "netcdf4.sofa")] if form == "binaural" else []
        earshot("ir", scene, "-o", out, "--order", "1", "--rays", "200", "--length", "0.2", "--sofa",
                "--listener", "far=4,1.2,-2", "--format", form, *ears)
        path = os.path.join(out, "responses.sofa")
        with open(os.path.join(out, "metrics.json"), encoding="utf-8") as metrics:
            pairs = [pair["source"] + "__" + pair["listener"] for pair in json.load(metrics)["pairs"]]
        assert len(pairs) > 1
        wavs = [wav_channels(os.path.join(out, pair + ".wav")) for pair in pairs]
        for read in (read_with_h5py, read_with_netcdf4, read_with_mysofa):
            file = read(path)
            where = f"{form}, {read.__name__}"
            # The WAV files are of single precision, the SOFA file is of double.
            assert file["Data.IR"].shape == (len(pairs), *wavs[0].shape), where
            assert np.array_equal(file["Data.IR"].astype(np.float32), np.array(wavs, np.float32)), where
            assert np.allclose(file["ReceiverPosition"], receivers), where
            assert file["Data.SamplingRate"] == [48000.0], where
            if "attributes" in file:
                assert file["receiver type"] == receiver_type, where
                assert file["attributes"]["SOFAConventions"] == "SingleRoomSRIR", where
                assert ("SN3D" in file["attributes"]["ReceiverDescription"]) == (len(receivers) == 9)


def head():
    """A head of 12 azimuths, Data.IR and SourcePosition."""
    samples = np.zeros((12, 2, 32))
    for m in range(12):
        shadow = np.sin(np.radians(30.0 * m))
        samples[m, 0, round(8 - 4 * shadow)] = 1 + 0.5 * shadow
        samples[m, 1, round(8 + 4 * shadow)] = 1 - 0.5 * shadow
    return samples, np.array([[30.0 * m, 0.0, 1.4] for m in range(12)])


ATTRIBUTES = {"Conventions": "SOFA", "Version": "2.1", "SOFAConventions": "SimpleFreeFieldHRIR",
              "SOFAConventionsVersion": "1.0", "DataType": "FIR", "RoomType": "free field"}
CARTESIAN = {"Type": "cartesian", "Units": "metre"}


def head_variables():
    samples, sources = head()
    return {"Data.IR": ("MRN", samples, {}),
            "Data.SamplingRate": ("I", np.array([48000.0]), {"Units": "hertz"}),
            "Data.Delay": ("IR", np.zeros((1, 2)), {}),
            "SourcePosition": ("MC", sources,
                               {"Type": "spherical", "Units": "degree, degree, metre"}),
            "EmitterPosition": ("ECI", np.zeros((1, 3, 1)), CARTESIAN),
            "ListenerPosition": ("IC", np.zeros((1, 3)), CARTESIAN),
            "ListenerView": ("IC", np.array([[1.0, 0.0, 0.0]]), CARTESIAN),
            "ListenerUp": ("IC", np.array([[0.0, 0.0, 1.0]]), {}),
            "ReceiverPosition": ("RCI", EARS[:, :, np.newaxis], CARTESIAN)}


def write_with_netcdf4(path):
    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts(ATTRIBUTES)
        for name, size in zip("MRNECI", (12, 2, 32, 1, 3, 1)):
            file.createDimension(name, size)
        for name, (dimensions, values, attributes) in head_variables().items():
            variable = file.createVariable(name, "f8", tuple(dimensions), zlib=True, shuffle=True)
            variable.setncatts(attributes)
            variable[:] = values


def write_with_h5py(path):
    with h5py.File(path, "w") as file:
        file.attrs.update(ATTRIBUTES)
        for name, (_, values, attributes) in head_variables().items():
            file.create_dataset(name, data=values).attrs.update(attributes)


def check_read(folder):
    responses = []
    for name, write in (("netcdf4", write_with_netcdf4), ("h5py", write_with_h5py)):
        path = os.path.join(folder, name + ".sofa")
        write(path)
        mesh = os.path.join(folder, "far.obj")
        open(mesh, "w").write("v 0 -50 0\nv 1 -50 0\nv 0 -50 1\nf 1 2 3\n")
        out = os.path.join(folder, "read_" + name)
        earshot("ir", mesh, "-o", out, "--source", "s=0,0,0", "--listener", "l=2,0,0", "--rays", "0",
                "--order", "0", "--format", "binaural", "--hrtf", path)
        responses.append(open(os.path.join(out, "s__l.wav"), "rb").read())
        # A source on the left, 2 m away, as the head above says: three times as loud there. An
        # impulse between two samples has the energy of one at a sample but for what lies above
        # 0.95 of half the sample rate, some tenth.
        ears = wav_channels(os.path.join(out, "s__l.wav"))
        left, right = 2.0 * np.sqrt(np.sum(ears ** 2, axis=1))
        assert 1.35 < left < 1.55 and abs(left / right - 3.0) < 0.03, (name, left, right)
    assert responses[0] == responses[1]


def check_damaged(folder):
    """A damaged file is one error that names it."""
    whole = open(os.path.join(folder, "h5py.sofa"), "rb").read()
    path = os.path.join(folder, "damaged.sofa")
    for cut in (0, 100, 3000, len(whole) // 2):
        open(path, "wb").write(whole[:cut])
        run = subprocess.run([PROGRAM, "ir", os.path.join(folder, "far.obj"), "-o", folder + "/none",
                              "--source", "s=0,0,0", "--listener", "l=2,0,0", "--rays", "0",
                              "--format", "binaural", "--hrtf", path],
                             capture_output=True, text=True, check=False, timeout=60)
        assert run.returncode == 1 and run.stdout == "", run
        assert run.stderr.startswith(f"earshot: error: {path}: "), run.stderr
        assert run.stderr.count("\n") == 1, run.stderr


with tempfile.TemporaryDirectory() as scratch:
    check_read(scratch)
    check_damaged(scratch)
    check_written(scratch)
print(f"h5py {h5py.__version__}, netCDF4 {netCDF4.__version__} and {MYSOFA} exchange SOFA files")
