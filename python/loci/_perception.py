"""Pipelines, and annotators written in Python."""

import inspect
import os
from typing import Any, Callable, Dict, List, Optional, Sequence, Type, Union

from . import _loci
from ._json import dumps
from ._loci import Cluster, Error, PerceivedScene
from ._memory import _Time
from .answers import Record, read


class Annotator:
    """An expert that reads a scene and adds to it. Derive from it, and give the class to run().

    class Redness(loci.Annotator):
        'Says how red each object looks.'
        inputs = ["Cluster", "StandaloneImageROI"]
        outputs = ["ClassificationAnnotation"]
        options = {"red": 0.5}

        def process(self, scene):
            for cluster in scene.clusters:
                ...

    inputs, outputs, optional_inputs: types of annotations by their short names, "Cluster", or views ("view:depth");
    what is not declared may not be there. options: names with defaults (bool, int, float or str); start() finds their
    values as attributes. An object is made for one run; an exception of it ends the run as a loci.Error.
    """

    inputs: Sequence[str] = ()
    outputs: Sequence[str] = ()
    optional_inputs: Sequence[str] = ()
    options: Dict[str, Any] = {}

    @property
    def name(self) -> str:
        """As pipelines name it."""
        return type(self).__name__

    @property
    def description(self) -> str:
        """One line."""
        return (inspect.getdoc(self) or self.name).split("\n")[0]

    def start(self) -> None:
        """Before the first frame; options are set."""

    def process(self, scene: PerceivedScene) -> None:
        """Called for each frame, one after the other."""
        raise NotImplementedError

    def finish(self) -> None:
        """After the last frame, also of a run that was interrupted or failed."""


def run(
    recording: Union[str, os.PathLike],
    *,
    pipeline: Union[str, os.PathLike, dict, None] = None,
    annotators: Sequence[Type[Annotator]] = (),
    types: Sequence[Union[str, os.PathLike]] = (),
    map: Union[str, os.PathLike] = "",
    memory: Union[str, os.PathLike] = "",
    resume: bool = False,
    fixed_camera: bool = False,
    threads: int = 0,
    every: int = 0,
    done: Optional[Callable[[PerceivedScene], Any]] = None,
    progress: Optional[Callable[[float, str], Optional[bool]]] = None,
    now: Optional[_Time] = None,
    **options: Any,
) -> Record:
    """Runs a perception pipeline over a recording, as `loci-perceive run` does.

    pipeline: a YAML file, YAML text or a dictionary; the default one without it
    annotators: classes of Python that it may name; those that it does not name come at its end
    types: type systems (XML) of their annotations
    map: URDF; memory: file to write to; resume: go on with a recording that the memory has in part
    fixed_camera: the camera of a recording without poses stood still
    threads: 0 = all cores; every: process every n-th frame, 0 = as the pipeline says
    done: called with each scene when all annotators are through
    options: of the recording, see open_recording()

    Returns how many frames were processed, skipped and left out, and the seconds of each annotator.
    """
    for each in annotators:
        if not (isinstance(each, type) and issubclass(each, Annotator) and each.process is not Annotator.process):
            raise Error(f"{each!r} is no class of annotators: derive it from loci.Annotator, with process(scene)")
    if every < 0:
        raise Error(f"every is {every}: 0 = as the pipeline says, n = every n-th frame")
    text, file = "", ""
    if isinstance(pipeline, os.PathLike) or (isinstance(pipeline, str) and pipeline.endswith((".yaml", ".yml"))):
        file = pipeline
    elif pipeline:
        text = pipeline if isinstance(pipeline, str) else dumps(pipeline, "pipeline")
    return read(
        _loci._run(
            recording, text, file, list(annotators), list(types), map, memory, resume, fixed_camera, threads, every,
            done, progress, now, **options
        )
    )


def default_pipeline() -> str:
    """The pipeline that is run when none is given, as YAML."""
    return _loci._default_pipeline()


def describe_annotators() -> List[Record]:
    """All annotators that there are: inputs, outputs and options."""
    return read(_loci._annotators())


def _annotate(self: Union[Cluster, PerceivedScene], type: str, **features: Any) -> None:
    """Adds an annotation of a type, by its short name, with features by name: numbers and texts, lists or arrays of them."""
    values = [f"{dumps(name, type)}: {dumps(value, f'{type}.{name}', finite=True)}" for name, value in features.items()]
    self._annotate(type, "{" + ", ".join(values) + "}")


def _annotations(self: Cluster) -> List[Record]:
    """What annotators said of it so far, in words, numbers and lists of them; `type` is the short name."""
    return read(self._annotations())


def _data(self: PerceivedScene) -> Record:
    """Supports, clusters and annotations as values: as `loci-perceive run --json` has them."""
    return read(self._data())


Cluster.annotate = _annotate
Cluster.annotations = property(_annotations)
PerceivedScene.annotate = _annotate
PerceivedScene.data = _data
