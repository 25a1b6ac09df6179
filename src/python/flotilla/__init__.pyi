# SPDX-License-Identifier: MIT
from ._core import *
from ._enums import ClusterState as ClusterState
from ._enums import StepWarning as StepWarning
from ._errors import BodyPair as BodyPair
from ._errors import BrokenPromise as BrokenPromise
from ._errors import Error as Error
from ._errors import InputError as InputError
from ._errors import IoError as IoError
from ._errors import OverlapError as OverlapError
from ._errors import OverlapPair as OverlapPair
from ._errors import Problem as Problem
from ._errors import ScriptError as ScriptError
from ._errors import StepCancelled as StepCancelled
from ._meshes import scene_from_meshes as scene_from_meshes
from ._picture import picture as picture
from ._run_folder import RunFolder as RunFolder
from ._run_folder import read_steps as read_steps
from ._sweep import sweep as sweep

__version__: str
