"""A kitchen's memory: maps, perception and questions.

    import loci

    with loci.open("memory.loci") as memory:
        print(memory.where("red cup"))
        for found in memory.objects().objects:
            print(found.object, found.place)

Images are arrays of numpy: colour as RGB, depth in metres with NaN where nothing was measured. Poses are 4 x 4
matrices named target_from_source. Times are datetime in UTC; questions also take what people say ("08:30").
"""

from . import _loci
from ._calls import shorten_errors

shorten_errors(_loci)

from ._loci import (
    Camera,
    Cluster,
    Error,
    Frame,
    Joint,
    Link,
    Map,
    Memory,
    Observation,
    PerceivedScene,
    Recording,
    RecordingWriter,
    Scene,
    Visual,
)
from ._loci import __version__
from ._mapping import open_recording
from ._memory import Edits, NotUnderstood, ingest, open
from ._perception import Annotator, default_pipeline, describe_annotators, run
from .answers import Answer, Fields, Record

__all__ = [
    "Annotator",
    "Answer",
    "Camera",
    "Cluster",
    "Edits",
    "Error",
    "Fields",
    "Frame",
    "Joint",
    "Link",
    "Map",
    "Memory",
    "NotUnderstood",
    "Observation",
    "PerceivedScene",
    "Record",
    "Recording",
    "RecordingWriter",
    "Scene",
    "Visual",
    "default_pipeline",
    "describe_annotators",
    "ingest",
    "open",
    "open_recording",
    "run",
]
