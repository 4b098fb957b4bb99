// SPDX-License-Identifier: MIT
#include "earshot/capi/earshot.h"

#define EARSHOT_TEXT_OF(x) #x
#define EARSHOT_TEXT(x) EARSHOT_TEXT_OF(x)

uint32_t es_version(void) {
    return ES_VERSION;
}

const char* es_version_text(void) {
    return EARSHOT_TEXT(ES_VERSION_MAJOR) "." EARSHOT_TEXT(ES_VERSION_MINOR) "." EARSHOT_TEXT(
        ES_VERSION_PATCH);
}
