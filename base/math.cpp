// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
