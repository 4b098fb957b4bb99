// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/hrir_reader.h"

#include "earshot/io/sofa.h"

namespace earshot::capi {

audio::HrirSet read_hrir_set(const char* file, bool raw) {
    audio::HrirSet set = io::read_hrir_set(file == nullptr ? io::kDefaultHrirSet : file);
    if (!raw) {
        set.centre_delay = audio::common_delay(set);
    }
    return set;
}

}  // namespace earshot::capi
