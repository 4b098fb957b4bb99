#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Puts the libraries that a wheel needs into it: carried_libraries.py WHEEL FOLDER.

A wheel for manylinux_2_36 (PEP 600) may expect the C and C++ libraries of glibc 2.36 and gcc 12 and
nothing else. All other libraries go into the package, under names with a digest, so that they do
not meet others of their name in one process; the terms of their packages go with them. Writes the
wheel with the platform's tag into FOLDER and prints a line for each library that it carries.
"""

import base64
import csv
import hashlib
import io
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

PLATFORM = "manylinux_2_36_x86_64"
GLIBC = (2, 36)
SYSTEM = re.compile(r"(lib(c|m|dl|rt|pthread|util|resolv|stdc\+\+|gcc_s)|ld-linux-x86-64)\.so\.\d+$")
CARRIED = "earshot/libraries"
# It brings HDF5 with a network stack; who has SOFA files builds the package from its sources.
LEFT_OUT = "earshot/libearshot-sofa.so"


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def needed(library):
    """Sonames of what a library links, the system's left out."""
    names = output("patchelf", "--print-needed", str(library)).split()
    return [name for name in names if not SYSTEM.match(name)]


def where(library):
    """From sonames to files, as the loader finds them for a library."""
    return dict(re.findall(r"^\s*(\S+) => (/\S+)", output("ldd", str(library)), re.MULTILINE))


def closure(library):
    """Files of all libraries behind one, by soname."""
    files, found, names = where(library), {}, needed(library)
    while names:
        name = names.pop()
        if name not in found:
            found[name] = pathlib.Path(files[name]).resolve()
            names += needed(found[name])
    return found


def require_old_glibc(library):
    versions = re.findall(r"GLIBC_(\d+)\.(\d+)", output("objdump", "-T", str(library)))
    newest = max((tuple(map(int, version)) for version in versions), default=(0, 0))
    if newest > GLIBC:
        sys.exit(f"{library}: needs glibc {newest[0]}.{newest[1]}; build it on an older system")


def package_of(file):
    """The Debian package that a library is of."""
    for name in (str(file), str(file).removeprefix("/usr")):
        found = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if found.returncode == 0:
            return found.stdout.split(":")[0]
    sys.exit(f"{file}: is of no package, so that nothing tells its licence")


def carry(root):
    """Copies the libraries into the unpacked wheel; returns (soname, package) of each."""
    library = root / "earshot/libearshot.so.0"
    require_old_glibc(library)
    files = closure(library)
    folder, terms = root / CARRIED, next(root.glob("*.dist-info")) / "licenses"
    folder.mkdir()
    terms.mkdir(exist_ok=True)
    names = {}
    for name, file in files.items():
        stem, _, version = name.partition(".so")
        digest = hashlib.sha256(file.read_bytes()).hexdigest()[:8]
        names[name] = f"{stem}-{digest}.so{version}"
    told = []
    for name, file in sorted(files.items()):
        require_old_glibc(file)
        copy, package = folder / names[name], package_of(file)
        shutil.copy(file, copy)
        copy.chmod(0o755)
        subprocess.run(["patchelf", "--set-soname", names[name], str(copy)], check=True)
        retarget(copy, names, "$ORIGIN")
        shutil.copy(f"/usr/share/doc/{package}/copyright", terms / f"{package}.txt")
        told.append((name, package))
    # strip moves the sections that patchelf adds, so it comes first.
    subprocess.run(["strip", "--strip-debug", str(library)], check=True)
    retarget(library, names, "$ORIGIN/libraries")
    return told


def retarget(library, names, path):
    """Lets a library find the others under their new names."""
    # Names and path one after the other: together, patchelf 0.14 gives libpng the name of zlib as
    # its path.
    changes = [option for name in needed(library) for option in ("--replace-needed", name, names[name])]
    if changes:
        subprocess.run(["patchelf", *changes, str(library)], check=True)
    subprocess.run(["patchelf", "--force-rpath", "--set-rpath", path, str(library)], check=True)


def pack(root, wheel):
    """Writes a wheel with its record; the same files give the same bytes."""
    info = next(root.glob("*.dist-info"))
    text = (info / "WHEEL").read_text()
    (info / "WHEEL").write_text(re.sub(r"^Tag: .*$", f"Tag: py3-none-{PLATFORM}", text,
                                       flags=re.MULTILINE))
    record, rows = info / "RECORD", io.StringIO()
    files = sorted(path for path in root.rglob("*") if path.is_file() and path != record)
    lines = csv.writer(rows, lineterminator="\n")
    for path in files:
        digest = base64.urlsafe_b64encode(hashlib.sha256(path.read_bytes()).digest())
        lines.writerow([path.relative_to(root), f"sha256={digest.rstrip(b'=').decode()}",
                        path.stat().st_size])
    lines.writerow([record.relative_to(root), "", ""])
    record.write_text(rows.getvalue())
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in [*files, record]:
            entry = zipfile.ZipInfo(str(path.relative_to(root)), (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in path.name else 0o644) << 16
            archive.writestr(entry, path.read_bytes())


def main(wheel, folder):
    with tempfile.TemporaryDirectory() as place:
        root = pathlib.Path(place)
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(root)
        (root / LEFT_OUT).unlink(missing_ok=True)
        told = carry(root)
        name = wheel.name.split("-")
        folder.mkdir(parents=True, exist_ok=True)
        pack(root, folder / f"{name[0]}-{name[1]}-py3-none-{PLATFORM}.whl")
    for soname, package in told:
        print(soname, package)


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:3]))
