#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the package's module _bindings from the C header: generate_bindings.py HEADER OUTPUT.

The module is Python that cffi reads at import in a millisecond; no compiler is needed.
"""

import pathlib
import re
import sys

import cffi


def with_parts(header: pathlib.Path) -> str:
    """The header's text with the headers beside it that it includes, each once."""
    seen: set[pathlib.Path] = set()

    def expanded(file: pathlib.Path) -> str:
        if file in seen:
            return ""
        seen.add(file)
        return re.sub(r'^#include "([^"]+)"$', lambda match: expanded(file.with_name(match[1])),
                      file.read_text(), flags=re.MULTILINE)

    return expanded(header)


def main(header: pathlib.Path, output: pathlib.Path) -> None:
    text = with_parts(header)
    text = re.sub(r"//[^\n]*", "", text)
    text = re.sub(r"^#.*(\\\n.*)*$", "", text, flags=re.MULTILINE)
    ffi = cffi.FFI()
    # The macro that exports a function stands for nothing here.
    ffi.cdef(re.sub(r"\bES_API\b", "", text))
    ffi.set_source("_bindings", None)
    ffi.emit_python_code(str(output))


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:3]))
