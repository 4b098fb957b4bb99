# The order of folders, as docs/architecture.md has it: `may_include_X` is all that X may include
# beside itself.
set(folders base geometry bvh collision visibility frustum audio propagation io)
set(may_include_base)
set(may_include_geometry base)
set(may_include_bvh geometry base)
set(may_include_collision bvh geometry base)
set(may_include_visibility bvh geometry base)
set(may_include_frustum bvh geometry base)
set(may_include_audio base)
set(may_include_propagation frustum visibility bvh audio geometry base)
set(may_include_io collision visibility propagation frustum bvh audio geometry base)
