// SPDX-License-Identifier: MIT
#include "earshot/io/png.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/io/whole_file.h"

#include <png.h>

namespace earshot::io {

std::string encode_png(const Picture& picture) {
    EARSHOT_ASSERT(picture.width > 0 && picture.width <= kMaxPictureSize);
    EARSHOT_ASSERT(picture.height > 0 && picture.height <= kMaxPictureSize);
    EARSHOT_ASSERT(picture.rgb.size() == 3 * picture.width * picture.height);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    // The size for pixels that deflate cannot compress is the upper bound.
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) ==
        0) {
        const std::string reason = image.message;
        png_image_free(&image);
        throw Error("picture", "cannot be encoded: " + reason, "choose a smaller one");
    }
    bytes.resize(size);
    return bytes;
}

void write_png(const std::filesystem::path& file, const Picture& picture) {
    write_whole_file(file, encode_png(picture));
}

}  // namespace earshot::io
