// SPDX-License-Identifier: MIT
#include "earshot/io/sofa.h"

#include "earshot/io/internal/hrir_set.h"
#include "earshot/io/internal/sofa_file.h"

namespace earshot::io {

audio::HrirSet read_hrir_set(const std::filesystem::path& file) {
    return hrir_set_of(read_sofa(file), file.string());
}

}  // namespace earshot::io
