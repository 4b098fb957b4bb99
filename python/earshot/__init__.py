# SPDX-License-Identifier: MIT
"""Sound propagation and geometric queries in scenes that move and deform.

>>> import earshot as es
>>> room = es.shoebox((5, 2.7, 4), absorption=0.3)
>>> _ = room.add_source("talker", (1, 1.5, 1))
>>> _ = room.add_listener("seat", (4, 1.2, 3))
>>> result = es.simulate(room, rays=0, order=2, length=0.1)
>>> result
<Result: 1 sources x 1 listeners, 1 x 4800 samples at 48000 Hz, 25 paths>

Metres, seconds, hertz; right-handed axes with +Y up. Arrays are numpy's, doubles unless said
otherwise; (n, 3) are n points. Results depend on the scene and the options alone, not on threads or
the processor.
"""

from ._errors import (
    ArgumentError,
    Cancelled,
    Error,
    MissingPackage,
    OutOfMemory,
    OutOfRange,
    UnknownName,
)
from ._library import NONE, Message, Messages, lib, text
from .bvh import Blockers, Bvh, ClosestPoints, Hits, Sight
from .calibration import Calibration, calibrate
from .checks import (
    FaceGroup,
    Finding,
    Hole,
    Leak,
    MaterialUse,
    Mending,
    Misplaced,
    ModelCheck,
    SmallFacets,
    check,
)
from .engine import Engine, EngineStatistics
from .locations import Located, Location, locate
from .maps import MapLimit, MetricMap, map
from .materials import LibraryMaterial, Material, band_centres, library
from .motion import auralize_moving, auralize_paths
from .names import Names
from .paths import PATH_TYPE, Path, Paths
from .plots import plot_decay, plot_echogram, plot_metric, plot_response, plot_scene
from .result import Histogram, Response, Result, Room, Sensitivity, write_sofa
from .scene import Scene, extrude, load, shoebox
from .simplification import Simplified, simplify
from .simulation import Simulator, simulate
from .sound import Sound, auralize, mix
from .visible_sets import VisibleSets
from .world import CONTACT_TYPE, Contact, Contacts, Depth, Distance, Element, MeshInWorld, World

__version__ = text(lib.es_version_text())

__all__ = [
    "CONTACT_TYPE",
    "NONE",
    "PATH_TYPE",
    "ArgumentError",
    "Blockers",
    "Bvh",
    "Calibration",
    "Cancelled",
    "ClosestPoints",
    "Contact",
    "Contacts",
    "Depth",
    "Distance",
    "Element",
    "Engine",
    "EngineStatistics",
    "Error",
    "FaceGroup",
    "Finding",
    "Histogram",
    "Hits",
    "Hole",
    "Leak",
    "LibraryMaterial",
    "Located",
    "Location",
    "MapLimit",
    "Material",
    "MaterialUse",
    "Mending",
    "MeshInWorld",
    "Message",
    "Messages",
    "MetricMap",
    "Misplaced",
    "MissingPackage",
    "ModelCheck",
    "Names",
    "OutOfMemory",
    "OutOfRange",
    "Path",
    "Paths",
    "Response",
    "Result",
    "Room",
    "Scene",
    "Sensitivity",
    "Sight",
    "Simplified",
    "Simulator",
    "SmallFacets",
    "Sound",
    "UnknownName",
    "VisibleSets",
    "World",
    "auralize",
    "auralize_moving",
    "auralize_paths",
    "band_centres",
    "calibrate",
    "check",
    "extrude",
    "library",
    "load",
    "locate",
    "map",
    "mix",
    "plot_decay",
    "plot_echogram",
    "plot_metric",
    "plot_response",
    "plot_scene",
    "shoebox",
    "simplify",
    "simulate",
    "write_sofa",
]
