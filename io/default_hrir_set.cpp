// SPDX-License-Identifier: MIT
#include "earshot/io/default_hrir_set.h"

#include "earshot/base/error.h"

#ifdef EARSHOT_DEFAULT_HRIR_SET

#include <cstdint>
#include <cstring>

// The file that io/generator/make_default_hrir_set.cpp writes, byte for byte.
asm(R"(
    .section .rodata
    .balign 8
    .type earshot_default_hrir_set, @object
    .global earshot_default_hrir_set
    .hidden earshot_default_hrir_set
earshot_default_hrir_set:
    .incbin ")" EARSHOT_DEFAULT_HRIR_SET R"("
    .size earshot_default_hrir_set, . - earshot_default_hrir_set
    .previous
)");
extern "C" const char earshot_default_hrir_set[];

namespace earshot::io {

namespace {

class Reader {
public:
    template <class Value>
    Value read() {
        Value value;
        std::memcpy(&value, next_, sizeof value);
        next_ += sizeof value;
        return value;
    }

    std::vector<double> samples(std::uint64_t count) {
        std::vector<double> result;
        result.reserve(count);
        for (std::uint64_t n = 0; n < count; ++n) {
            result.push_back(read<float>());
        }
        return result;
    }

private:
    const char* next_ = earshot_default_hrir_set;
};

}  // namespace

audio::HrirSet default_hrir_set() {
    Reader reader;
    audio::HrirSet set;
    set.sample_rate = reader.read<double>();
    set.centre_delay = reader.read<double>();
    const auto count = reader.read<std::uint64_t>();
    const auto taps = reader.read<std::uint64_t>();
    set.directions.resize(count);
    for (audio::Hrir& direction : set.directions) {
        direction.towards = reader.read<std::array<double, 3>>();
        direction.distance = reader.read<double>();
        direction.left = reader.samples(taps);
        direction.right = reader.samples(taps);
    }
    return set;
}

}  // namespace earshot::io

#else

namespace earshot::io {

audio::HrirSet default_hrir_set() {
    throw Error("default HRIR set",
                "is missing: earshot was built without the KEMAR data of the package libmysofa1",
                "give a SOFA file with --hrtf, or install the package and build again");
}

}  // namespace earshot::io

#endif
