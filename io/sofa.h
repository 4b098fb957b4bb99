// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"

#include <filesystem>

namespace earshot::io {

/// Head responses of a KEMAR manikin (Gardner and Martin 1995), where Debian's libmysofa1 has them.
inline constexpr const char* kDefaultHrirSet = "/usr/share/libmysofa/MIT_KEMAR_normal_pinna.sofa";

/// Reads the head-related impulse responses of a SOFA file (AES69): SimpleFreeFieldHRIR,
/// FreeFieldHRIR with discrete emitters, GeneralFIR and GeneralFIR-E, of two receivers in any
/// order. Directions and distances are those from the listener, in the axes of its view; delays
/// that stand beside the responses are put into them; measurements of lower sample rates are
/// resampled to the highest. A measurement and an emitter each make an entry of the set, in the
/// order of the file, at the distance that the file gives.
///
/// HDF5 reads the file in a child process with limits of time and memory, which is forked from this
/// one (15 s of processor time, 30 s, 2 GiB). Throws Error naming the file and the reason if it
/// cannot be read, is of another kind, or holds values that are not finite.
audio::HrirSet read_hrir_set(const std::filesystem::path& file);

}  // namespace earshot::io
