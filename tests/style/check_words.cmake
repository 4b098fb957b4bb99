# Fails if a source uses a private word where the field has a standard term (CONTRIBUTING.md,
# docs/glossary.md). A word is a whole identifier or a whole word of a comment, given as a regular
# expression; the term beside it is what to write instead.
# Arguments: SOURCE_DIR.
set(words
  # limits
  "kMost[A-Z][A-Za-z]*" "kMax..."
  "most_[a-z_]*" "max_..."
  "(least|fewest)_[a-z_]*" "min_..."
  # flags
  "leaves_out_[a-z_]*" "skip_..."
  "keeps_front" "track_front"
  "tells_directions" "report_directions"
  "is_refined" "refine"
  "is_guided" "guided_sampling"
  # bvh
  "[Ww]aiting_?" "stack, stack entry"
  "wait_for" "push"
  "Bundle|trace_bundle" "ray packet"
  "stream_steps|kTogether|ClosestLane" "interleaved traversal, rays in flight"
  "alone_steps|descend_alone" "single-ray kernel"
  "few_triangles|ClosestOfFew" "brute-force kernel, small mesh"
  "Passing|Passage|PassingFromPlane" "slab test, interval"
  "LeavingRays|LeftPlane" "secondary rays, excluded triangle"
  "LeafRoom|LeafForm" "decode buffer, leaf encoding"
  "DecisionQueue|Verdicts|Piercings" "deferred exact test, intersections"
  "aging|expected_steps" "tree degradation, SAH cost"
  "Remedy" "rebuild accounting"
  # frustum
  "Harvest" "task result"
  "Audience" "listeners"
  "ListenerSide|LastPair" "listener beams, last two reflections"
  "all_the_way|are_many" "forward-only tracing"
  "Looks?|SourceTrace" "beam-tree node, beam tree"
  "Proposer|propose_from" "candidate sequences"
  "WindowSight|may_pass_window" "aperture test"
  "Surroundings" "scene view"
  "lets_through" "transmissive"
  "coats" "coincident layer"
  # collision
  "SweptForest|JoinedTrees" "swept-volume BVH, merged BVH"
  "PairFront|PartSearch" "BVTT front, self-traversal"
  "SmoothPatches|face_one_way" "continuous normal cones"
  "moving_loop" "contour test"
  "LeafPlates|is_beside" "leaf slabs, separating slab"
  "MotionSlabs|MotionPlaces" "swept k-DOP, its extents"
  "own_elements|assigns_elements" "representative triangles"
  "Guest|GuestFrame" "relative pose"
  "are_apart|meet_beyond_shared" "disjoint, intersect beyond shared features"
  "Bends|halve" "Bernstein coefficients, subdivide"
  # visibility
  "Ignored" "exclusion mask"
  "share_behind|leaf_contacts" "volume behind a plane, cell adjacency"
  "drawn_in" "inset, shortened"
  # propagation and audio
  "Drops?|let_it_rain" "secondary source, diffuse rain"
  "RayEar" "receiver sphere"
  "kFlock" "batch"
  "volume_in_sight|chance_heard" "visible volume, rain probability"
  "HeadResponses?|HeardPair" "HRIR set, response with metrics"
  # geometry and base
  "turn_mirrored" "flip winding"
  "but_not" "and_not"
  "lesser" "min"
)

set(standard_terms)
set(all)
while(words)
  list(POP_FRONT words word term)
  list(APPEND all "${word}")
  list(APPEND standard_terms "${term}")
endwhile()
list(JOIN all "|" any)

file(GLOB entries RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*)
list(REMOVE_ITEM entries build out)
set(count 0)
set(complaints)
foreach(folder IN LISTS entries)
  file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR}
    ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp ${SOURCE_DIR}/${folder}/*.ts)
  list(FILTER sources EXCLUDE REGEX "/node_modules/")
  # Names of materials are data: "audience" is one.
  list(FILTER sources EXCLUDE REGEX "^propagation/(.*/)?material_")
  foreach(source IN LISTS sources)
    math(EXPR count "${count} + 1")
    file(READ ${SOURCE_DIR}/${source} text)
    string(REGEX MATCHALL "[A-Za-z_][A-Za-z0-9_]*" found "${text}")
    list(REMOVE_DUPLICATES found)
    list(FILTER found INCLUDE REGEX "^(${any})$")
    # "Least squares" is the name of the method.
    list(FILTER found EXCLUDE REGEX "^least_squares(_available)?$")
    foreach(word IN LISTS found)
      foreach(expression term IN ZIP_LISTS all standard_terms)
        if(word MATCHES "^(${expression})$")
          string(APPEND complaints "  ${source}: ${word}; standard: ${term}\n")
        endif()
      endforeach()
    endforeach()
  endforeach()
endforeach()
if(count EQUAL 0)
  message(FATAL_ERROR "no sources found below ${SOURCE_DIR}")
endif()
if(complaints)
  message(FATAL_ERROR "private words (see docs/glossary.md):\n${complaints}")
endif()
message(STATUS "${count} sources use the standard terms")
