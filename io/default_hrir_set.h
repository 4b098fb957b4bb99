// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"

namespace earshot::io {

/// The HRIR set of binaural responses where the user names none: the KEMAR manikin of Gardner and
/// Martin 1995, diffuse-field equalised (audio::diffuse_field_equalised). The build makes it from
/// the SOFA file of Debian's package libmysofa1 and the library carries it. Throws Error if that
/// file was missing when the library was built.
///
/// The data is Copyright 1994 by the MIT Media Laboratory. It is provided free with no restrictions
/// on use, provided the authors are cited when the data is used in any research or commercial
/// application.
audio::HrirSet default_hrir_set();

}  // namespace earshot::io
