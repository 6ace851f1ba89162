"""A kitchen's memory: maps, perception and questions.

    import loci

    with loci.open("memory.loci") as memory:
        print(memory.where("red cup"))
        for found in memory.objects().objects:
            print(found.object, found.place)

Images are arrays of numpy: colour as RGB, depth in metres with NaN where nothing was measured. Poses are 4 x 4
matrices named target_from_source. Times are datetime in UTC; questions also take what people say ("08:30").
"""

from ._loci import Camera, Error, Memory, Observation, Scene
from ._memory import Answer, NotUnderstood, Record, ingest, open

__all__ = [
    "Answer",
    "Camera",
    "Error",
    "Memory",
    "NotUnderstood",
    "Observation",
    "Record",
    "Scene",
    "ingest",
    "open",
]
