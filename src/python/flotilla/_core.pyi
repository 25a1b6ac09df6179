# SPDX-License-Identifier: MIT
# Types of the compiled part; what things are, their units and shapes say the docstrings. An attribute that is Final
# here is read only.
from typing import Any, Callable, Final, Iterable, Mapping, Sequence

from numpy import float64, int32, int64
from numpy.typing import ArrayLike, NDArray

from ._enums import StepWarning
from ._typing import EditsLike, KeyframeLike, MeshLike, Path, SceneLike, SettingValue

class SettingInfo:
    key: Final[str]
    type: Final[str]
    unit: Final[str]
    range: Final[str]
    default_value: Final[str]
    description: Final[str]
    effect: Final[str]

class Settings:
    def __init__(self, preset: str | None = "balanced", **changes: SettingValue) -> None: ...
    time_step: float
    substeps: int
    friction: float
    restitution: float
    seed: int
    rest_distance: float
    proximity_distance: float
    separation: float
    proximity_angle: float
    approach_threshold: float
    collisions: str
    collision_iterations: int
    collision_pair_iterations: int
    dynamic_iterations: int
    dynamic_pair_iterations: int
    static_iterations: int
    static_tolerance: float
    tolerance_share: float
    contact_reuse: float
    warm_start: bool
    shock_propagation: bool
    sleeping: bool
    trajectory: str
    ccd: str
    contact_solver: str
    tangents: str
    velocity_update: str
    rigidification: str
    unsatisfiable_script: str
    initial_overlap: str
    def validate(self) -> list[str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def __eq__(self, other: Any) -> bool: ...

class StepReport:
    step: Final[int]
    time: Final[float]
    total_ms: Final[float]
    phase_ms: Final[dict[str, float]]
    pairs: Final[int]
    collisions: Final[int]
    contacts: Final[int]
    iterations: Final[int]
    residual: Final[float]
    merges: Final[int]
    rung_changes: Final[int]
    held: Final[int]
    energy: Final[float]
    momentum: Final[NDArray[float64]]
    min_distance: Final[float]
    state_hash: Final[int]
    angular_momentum: Final[NDArray[float64]]
    kinetic_energy: Final[float]
    kinematic_bodies: Final[int]
    rigid_bodies: Final[int]
    largest_cluster: Final[int]
    trigger_a: Final[int]
    trigger_b: Final[int]
    sleeping: Final[int]
    sleeping_contacts: Final[int]
    warnings: Final[StepWarning]
    energy_corrections: Final[int]
    energy_removed: Final[float]
    lift: Final[float]
    proximities: Final[int]
    pruned_end_points: Final[int]
    pruned_same_direction: Final[int]
    pruned_angle: Final[int]
    pruned_occluded: Final[int]
    def to_dict(self) -> dict[str, Any]: ...

class BodyState:
    position: Final[NDArray[float64]]
    rotation: Final[NDArray[float64]]
    center_of_mass: Final[NDArray[float64]]
    velocity: Final[NDArray[float64]]
    angular_velocity: Final[NDArray[float64]]

class WayPoint:
    position: Final[NDArray[float64]]
    rotation: Final[NDArray[float64]]
    turn: Final[NDArray[float64]]

class MovedBody:
    body: Final[int]
    by: Final[NDArray[float64]]

class ThreadReport:
    busy_ms: Final[float]
    waiting_ms: Final[float]
    tasks: Final[int]
    stolen: Final[int]

class Shape:
    name: Final[str]
    mesh_path: Final[str]
    scale: Final[float]
    vertices: Final[NDArray[float64]]
    faces: Final[NDArray[int32]]
    mass_kind: Final[str]
    mass_value: Final[float]
    inertia: Final[NDArray[float64] | None]
    center_of_mass: Final[NDArray[float64] | None]

class Body:
    name: str
    shape: Final[int]
    type: str
    @property
    def position(self) -> NDArray[float64]: ...
    @position.setter
    def position(self, value: ArrayLike) -> None: ...
    @property
    def rotation(self) -> NDArray[float64]: ...
    @rotation.setter
    def rotation(self, value: ArrayLike) -> None: ...
    @property
    def velocity(self) -> NDArray[float64]: ...
    @velocity.setter
    def velocity(self, value: ArrayLike) -> None: ...
    @property
    def angular_velocity(self) -> NDArray[float64]: ...
    @angular_velocity.setter
    def angular_velocity(self, value: ArrayLike) -> None: ...
    friction: float
    restitution: float
    @property
    def force(self) -> NDArray[float64]: ...
    @force.setter
    def force(self, value: ArrayLike) -> None: ...
    @property
    def torque(self) -> NDArray[float64]: ...
    @torque.setter
    def torque(self, value: ArrayLike) -> None: ...
    group: str
    @property
    def locked(self) -> tuple[str, ...]: ...
    @locked.setter
    def locked(self, value: Iterable[str]) -> None: ...
    @property
    def keyframes(self) -> tuple[tuple[float, NDArray[float64], NDArray[float64]], ...]: ...
    @keyframes.setter
    def keyframes(self, value: Iterable[KeyframeLike]) -> None: ...

class Scene:
    def __init__(
        self, *, gravity: ArrayLike = ..., preset: str | None = "balanced",
        settings: Mapping[str, SettingValue] | None = None
    ) -> None: ...
    @property
    def gravity(self) -> NDArray[float64]: ...
    @gravity.setter
    def gravity(self, value: ArrayLike) -> None: ...
    settings: Settings
    shapes: Final[tuple[Shape, ...]]
    bodies: Final[tuple[Body, ...]]
    def add_shape(
        self, mesh: MeshLike, *, name: str | None = None, scale: float = 1.0, surface_density: float | None = None,
        density: float | None = None, mass: float | None = None, line_density: float | None = None,
        inertia: ArrayLike | None = None, center_of_mass: ArrayLike | None = None
    ) -> int: ...
    def add_body(
        self, shape: int | str, *, name: str | None = None, type: str = "dynamic", position: ArrayLike = ...,
        rotation: ArrayLike = ..., velocity: ArrayLike = ..., angular_velocity: ArrayLike = ...,
        friction: float | None = None, restitution: float | None = None, keyframes: Iterable[KeyframeLike] = (),
        locked: Iterable[str] = (), force: ArrayLike = ..., torque: ArrayLike = ..., group: str = ""
    ) -> int: ...
    def ignore_groups(self, a: str, b: str) -> None: ...
    def ignore_bodies(self, a: str, b: str) -> None: ...
    ignored_groups: Final[list[tuple[str, str]]]
    ignored_bodies: Final[list[tuple[str, str]]]
    def to_json(self, inline_meshes: bool = True) -> str: ...
    def to_dict(self) -> Any: ...

class SceneOrigin:
    format: Final[str]
    warnings: Final[list[str]]
    duration: Final[float]

class LibraryScene:
    name: Final[str]
    default_bodies: Final[int]
    min_bodies: Final[int]
    max_bodies: Final[int]
    description: Final[str]

class BodyId:
    def __init__(self, index: int, generation: int = 0) -> None: ...
    index: Final[int]
    generation: Final[int]
    def __eq__(self, other: Any) -> bool: ...

class RayHit:
    body: Final[BodyId]
    triangle: Final[int]
    distance: Final[float]
    point: Final[NDArray[float64]]
    normal: Final[NDArray[float64]]

class ClosestPoints:
    distance: Final[float]
    point_a: Final[NDArray[float64]]
    point_b: Final[NDArray[float64]]
    triangle_a: Final[int]
    triangle_b: Final[int]

class BodyContacts:
    contacts: Final[NDArray[Any]]
    force: Final[NDArray[float64]]
    torque: Final[NDArray[float64]]

class MemoryUse:
    shapes: Final[int]
    bodies: Final[int]
    contacts: Final[int]
    pairs: Final[int]
    total: Final[int]

class Edit:
    step: int
    kind: Final[str]

class World:
    def __init__(
        self, scene: SceneLike, *, preset: str | None = None, settings: Mapping[str, SettingValue] | None = None,
        snapshot: bytes | None = None, threads: int = 0, executor: str = "parallel"
    ) -> None: ...
    def step(self, n: int = 1) -> StepReport: ...
    def snapshot(self) -> bytes: ...
    def restore(self, snapshot: bytes) -> None: ...
    def clone(self, *, threads: int = 0, executor: str = "parallel") -> World: ...
    def __len__(self) -> int: ...
    positions: Final[NDArray[float64]]
    rotations: Final[NDArray[float64]]
    centers_of_mass: Final[NDArray[float64]]
    velocities: Final[NDArray[float64]]
    angular_velocities: Final[NDArray[float64]]
    turns: Final[NDArray[float64]]
    positions_view: Final[NDArray[float64]]
    rotations_view: Final[NDArray[float64]]
    centers_of_mass_view: Final[NDArray[float64]]
    velocities_view: Final[NDArray[float64]]
    angular_momenta_view: Final[NDArray[float64]]
    contacts_view: Final[NDArray[Any]]
    def body(self, index: int) -> BodyState: ...
    def way(self, index: int) -> list[WayPoint]: ...
    names: Final[list[str]]
    types: Final[list[str]]
    steps: Final[int]
    time: Final[float]
    settings: Final[Settings]
    contacts: Final[NDArray[Any]]
    activity: Final[NDArray[Any]]
    moved_bodies: Final[list[MovedBody]]
    state_hash: Final[int]
    scene_hash: Final[int]
    threads: Final[list[ThreadReport]]
    def scene(self) -> Scene: ...
    def scene_now(self) -> Scene: ...
    def add_shape(self, mesh: MeshLike, **options: Any) -> int: ...
    def remove_shape(self, shape: int | str) -> None: ...
    def add_body(self, shape: int | str, **options: Any) -> BodyId: ...
    def remove_body(self, body: BodyId) -> None: ...
    def id(self, index: int) -> BodyId: ...
    def find(self, name: str) -> BodyId: ...
    def contains(self, body: BodyId) -> bool: ...
    def wake(self, body: BodyId) -> None: ...
    def generation(self, index: int) -> int: ...
    def name(self, body: BodyId) -> str: ...
    def description(self, body: BodyId) -> Body: ...
    def set_user_data(self, body: BodyId, data: int) -> None: ...
    def user_data(self, body: BodyId) -> int: ...
    def set_pose(self, body: BodyId, position: ArrayLike, rotation: ArrayLike = ...) -> None: ...
    def set_velocity(self, body: BodyId, velocity: ArrayLike, angular_velocity: ArrayLike = ...) -> None: ...
    def set_type(self, body: BodyId, type: str) -> None: ...
    def set_script(self, body: BodyId, keyframes: Iterable[KeyframeLike]) -> None: ...
    def set_material(self, body: BodyId, friction: float, restitution: float) -> None: ...
    def set_force(self, body: BodyId, force: ArrayLike, torque: ArrayLike = ...) -> None: ...
    def apply_force(self, body: BodyId, force: ArrayLike, point: ArrayLike) -> None: ...
    def apply_torque(self, body: BodyId, torque: ArrayLike) -> None: ...
    def apply_impulse(self, body: BodyId, impulse: ArrayLike, point: ArrayLike) -> None: ...
    def set_gravity(self, gravity: ArrayLike) -> None: ...
    def set_group(self, body: BodyId, group: str) -> None: ...
    def ignore_groups(self, a: str, b: str, ignored: bool = True) -> None: ...
    def ignore_pair(self, a: BodyId, b: BodyId, ignored: bool = True) -> None: ...
    def apply(self, edit: Edit) -> BodyId | int | None: ...
    def record_edits(self, record: bool = True) -> None: ...
    recorded_edits: Final[list[Edit]]
    def set_force_callback(self, callback: Callable[[World], object] | None) -> None: ...
    def set_observer(self, observer: Callable[[str], bool | None] | None) -> None: ...
    def set_log(self, log: Callable[[str], object] | None) -> None: ...
    def ray(self, origin: ArrayLike, direction: ArrayLike, reach: float) -> RayHit | None: ...
    def closest(self, a: BodyId, b: BodyId) -> ClosestPoints: ...
    def overlapping(self, shape: int | str, position: ArrayLike, rotation: ArrayLike = ...) -> list[BodyId]: ...
    def bodies_in(self, lower: ArrayLike, upper: ArrayLike) -> list[BodyId]: ...
    def contacts_of(self, body: BodyId) -> BodyContacts: ...
    memory: Final[MemoryUse]
    gravity: Final[NDArray[float64]]
    energy: Final[float]
    ids: Final[list[BodyId]]
    num_bodies: Final[int]

class RunTotals:
    steps: Final[int]
    resumed_after: Final[int]
    complete: Final[bool]
    bodies: Final[int]
    total_ms: Final[float]
    worst_ms: Final[float]
    output_ms: Final[float]
    phase_ms: Final[dict[str, float]]
    collisions: Final[int]
    merges: Final[int]
    rung_changes: Final[int]
    held: Final[int]
    above_tolerance: Final[int]
    energy_corrections: Final[int]
    energy_removed: Final[float]
    min_distance: Final[float]
    last: Final[StepReport]
    traced_steps: Final[int]
    threads: Final[list[ThreadReport]]

class RunSummary:
    status: Final[str]
    version: Final[str]
    commit: Final[str]
    compiler: Final[str]
    processor: Final[str]
    started: Final[str]
    updated: Final[str]
    command_line: Final[list[str]]
    threads: Final[int]
    time_step: Final[float]
    substeps: Final[int]
    bodies: Final[int]
    dynamic_bodies: Final[int]
    shapes: Final[int]
    triangles: Final[int]
    frames: Final[int]
    last_step: Final[int]
    last_time: Final[float]
    frame_bytes: Final[int]
    checkpoint_step: Final[int]
    problems: Final[list[str]]
    settings_json: Final[str]

class Frames:
    bodies: Final[list[str]]
    frame: Final[NDArray[int64]]
    step: Final[NDArray[int64]]
    time: Final[NDArray[float64]]
    positions: Final[NDArray[float64]]
    rotations: Final[NDArray[float64]]
    velocities: Final[NDArray[float64]]
    angular_velocities: Final[NDArray[float64]]
    contacts: Final[NDArray[int64] | None]
    cluster: Final[NDArray[int64] | None]
    cost: Final[NDArray[int64] | None]
    def __len__(self) -> int: ...

class ComparedValue:
    name: Final[str]
    a: Final[str]
    b: Final[str]

class DifferentStep:
    step: Final[int]
    time: Final[float]
    state: Final[bool]
    columns: Final[list[ComparedValue]]
    stage: Final[str]

class DifferentWork:
    step: Final[int]
    columns: Final[list[ComparedValue]]

class BodyDifference:
    body: Final[int]
    name: Final[str]
    position: Final[float]
    rotation: Final[float]
    velocity: Final[float]
    angular_velocity: Final[float]
    activity: Final[bool]

class DifferentFrame:
    step: Final[int]
    frame_a: Final[int]
    frame_b: Final[int]
    time: Final[float]
    bodies: Final[int]
    first: Final[BodyDifference]
    farthest: Final[BodyDifference]

class CompareReport:
    inputs: Final[list[ComparedValue]]
    record: Final[list[ComparedValue]]
    same_bodies: Final[bool]
    steps_a: Final[int]
    steps_b: Final[int]
    steps_compared: Final[int]
    last_step: Final[int]
    first_step: Final[DifferentStep | None]
    first_state: Final[DifferentStep | None]
    first_work: Final[DifferentWork | None]
    frames_a: Final[int]
    frames_b: Final[int]
    frames_compared: Final[int]
    last_frame_step: Final[int]
    first_frame: Final[DifferentFrame | None]
    last_frame: Final[DifferentFrame | None]
    unreadable: Final[list[str]]
    same_inputs: Final[bool]
    same_bits: Final[bool]
    promise_broken: Final[bool]

class VerifyFault:
    kind: Final[str]
    frame: Final[int]
    time: Final[float]
    body_a: Final[int]
    body_b: Final[int]
    name_a: Final[str]
    name_b: Final[str]
    triangle_a: Final[int]
    triangle_b: Final[int]
    triangle_pairs: Final[int]
    place: Final[NDArray[float64]]
    reason: Final[str]
    def __str__(self) -> str: ...

class VerifyReport:
    proved: Final[bool]
    bodies: Final[int]
    frames: Final[int]
    motions: Final[int]
    motions_skipped: Final[int]
    pairs: Final[int]
    motion_pairs: Final[int]
    triangle_pairs: Final[int]
    intersecting_pairs: Final[int]
    crossing_pairs: Final[int]
    unproved_pairs: Final[int]
    bad_poses: Final[int]
    faults: Final[list[VerifyFault]]
    unreadable: Final[list[str]]
    notes: Final[list[str]]
    smallest_distance: Final[float]
    smallest_distance_frame: Final[int]
    smallest_distance_a: Final[str]
    smallest_distance_b: Final[str]
    seconds: Final[float]

class HtmlReport:
    frames: Final[int]
    frames_shown: Final[int]
    position_error: Final[float]
    rotation_error: Final[float]
    bytes: Final[int]
    problems: Final[list[str]]
    verification: Final[VerifyReport | None]

class SweepMember:
    name: Final[str]
    scene: Final[Path]
    folder: Final[Path]
    log: Final[Path]
    preset: Final[str]
    settings: Final[dict[str, str]]
    steps: Final[int]
    frame_every: Final[int]
    threads: Final[int]

class SweepMetric:
    name: Final[str]
    unit: Final[str]
    description: Final[str]
    truth: Final[str]
    needs_reference: Final[bool]

class SweepAxis:
    key: Final[str]
    values: Final[list[str]]

class SweepValue:
    mean: Final[float]
    spread: Final[float]
    starts: Final[int]

class SweepPoint:
    label: Final[str]
    values: Final[list[str]]
    reference: Final[bool]
    complete: Final[int]
    cost: Final[SweepValue]
    values_of: Final[list[SweepValue]]
    errors: Final[list[SweepValue]]
    on_front: Final[bool]

class SweepChange:
    key: Final[str]
    from_: Final[str]
    to: Final[str]
    cost_ratio: Final[float]
    error_ratio: Final[float]
    gain: Final[float]
    cost_from: Final[SweepValue]
    cost_to: Final[SweepValue]
    error_from: Final[SweepValue]
    error_to: Final[SweepValue]

class SweepReport:
    axes: Final[list[SweepAxis]]
    starts: Final[list[str]]
    metrics: Final[list[SweepMetric]]
    headline: Final[int]
    chaotic: Final[bool]
    size: Final[float]
    duration: Final[float]
    points: Final[list[SweepPoint]]
    base: Final[int]
    changes: Final[list[SweepChange]]
    advice: Final[list[str]]
    problems: Final[list[str]]
    remarks: Final[list[str]]
    members: Final[int]
    complete: Final[int]
    stopped: Final[bool]
    exit_code: Final[int]

class PictureReport:
    frame: Final[int]
    frames: Final[int]
    time: Final[float]
    bodies: Final[int]

class StepPictureReport:
    step: Final[int]
    time: Final[float]
    bodies: Final[int]
    contacts: Final[int]
    loaded_pairs: Final[int]
    sleeping_pairs: Final[int]
    touching_pairs: Final[int]
    near_pairs: Final[int]
    largest_impulse: Final[float]
    proved_by_query: Final[int]
    proved_by_boxes: Final[int]
    proved_by_cluster: Final[int]
    proved_by_rest: Final[int]
    not_proved: Final[int]

class InitialIntersection:
    body_a: Final[str]
    body_b: Final[str]
    triangle_pairs: Final[int]
    place: Final[NDArray[float64]]
    triangles_a: Final[NDArray[float64]]
    triangles_b: Final[NDArray[float64]]

class InitialRepair:
    body: Final[str]
    by: Final[NDArray[float64]]

class SceneCheck:
    dynamic_bodies: Final[int]
    static_bodies: Final[int]
    kinematic_bodies: Final[int]
    locked_bodies: Final[int]
    driven_bodies: Final[int]
    shapes: Final[int]
    triangles: Final[int]
    mass: Final[float]
    warnings: Final[list[str]]
    intersections: Final[list[InitialIntersection]]
    repairs: Final[list[InitialRepair]]
    ignored_intersections: Final[list[InitialIntersection]]

class TraceCosts:
    cores: Final[int]
    fork_join: Final[float]
    barrier: Final[float]
    hand_over: Final[float]

class TraceRow:
    name: Final[str]
    kind: Final[str]
    depth: Final[int]
    count: Final[int]
    regions: Final[int]
    tasks: Final[int]
    wall_ms: Final[float]
    serial_ms: Final[float]
    work_ms: Final[float]
    critical_path_ms: Final[float]
    parallelism: Final[float]
    speedup: Final[list[float]]

class TraceReport:
    version: Final[str]
    commit: Final[str]
    processor: Final[str]
    command_line: Final[list[str]]
    threads: Final[int]
    recordings: Final[int]
    steps: Final[int]
    trace_every: Final[int]
    wall_seconds: Final[float]
    cpu_seconds: Final[float]
    covered: Final[float]
    cores: Final[list[int]]
    costs: Final[list[TraceCosts]]
    measured_cores: Final[int]
    total: Final[TraceRow]
    rows: Final[list[TraceRow]]
    notes: Final[list[str]]

class CcdFileReport:
    rows: Final[int]
    positives: Final[int]
    missed: Final[int]
    late: Final[int]
    false_hits: Final[int]
    ns_per_query: Final[float]

def build_info() -> dict[str, str]: ...

def list_settings() -> list[SettingInfo]: ...

def preset_names() -> list[str]: ...

def read_scene(
    scene: SceneLike, *, preset: str | None = None, settings: Mapping[str, SettingValue] | None = None
) -> Scene: ...

def scene_origin(scene: SceneLike) -> SceneOrigin: ...

def write_scene(scene: Scene, path: Path, *, inline_meshes: bool = True) -> None: ...

def read_edits(edits: EditsLike, scene: SceneLike) -> list[Edit]: ...

def write_edits(edits: EditsLike, scene: SceneLike, path: Path) -> None: ...

def list_scenes() -> list[LibraryScene]: ...

def make_scene(name: str, *, bodies: int = 0, seed: int = 0) -> Scene: ...

def run(
    scene: SceneLike, output: Path = "", *, steps: int | None = None, duration: float | None = None,
    preset: str | None = None, settings: Mapping[str, SettingValue] | None = None, overwrite: bool = False,
    resume: bool = False, frame_every: int = 1, checkpoint_every: int = 0, threads: int = 0, executor: str = "parallel",
    trace: Path = "", trace_every: int = 1, contacts: Path = "", edits: EditsLike | None = None,
    after_step: Callable[[StepReport], bool | None] | None = None,
    blocked: Callable[[RunTotals], object] | None = None, note: Callable[[str], object] | None = None
) -> RunTotals: ...

def compare_runs(a: Path, b: Path) -> CompareReport: ...

def summarize_run(folder: Path) -> RunSummary: ...

def read_frames(folder: Path, *, first: int = 0, last: int | None = None, every: int = 1) -> Frames: ...

def export_run(
    folder: Path, format: str, output: Path, *, first: int = 0, last: int | None = None, every: int = 1
) -> None: ...

def estimate_export(
    folder: Path, format: str, *, first: int = 0, last: int | None = None, every: int = 1
) -> tuple[int, int]: ...

def write_report(
    folder: Path, output: Path, *, verify: bool = False, threads: int = 0, frame_every: int = 0
) -> HtmlReport: ...

def verify(
    source: Path, poses: Path = "", *, threads: int = 0, motion: str = "automatic", distance: bool = True,
    max_faults: int = 1000, progress: Callable[[float], object] | None = None
) -> VerifyReport: ...

def write_step_picture(
    source: World | Path, output: Path, step: int | None = None, *, lines: str = "contacts",
    progress: Callable[[int, int], object] | None = None, **kwargs: Any
) -> StepPictureReport: ...

def sweep_metrics() -> list[SweepMetric]: ...

def check_scene(
    scene: SceneLike, *, preset: str | None = None, settings: Mapping[str, SettingValue] | None = None
) -> SceneCheck: ...

def write_intersections(intersections: Sequence[InitialIntersection], path: Path) -> None: ...

def plan(
    scene: SceneLike, *, preset: str | None = None, settings: Mapping[str, SettingValue] | None = None
) -> list[tuple[str, str]]: ...

def analyze_trace(
    files: Sequence[Path], *, cores: list[int] = ..., growth: str = "log2", assume_costs: bool = False
) -> TraceReport: ...

def evaluate_ccd_file(path: Path, *, method: str = "conservative", separation: float = 0.0) -> CcdFileReport: ...
