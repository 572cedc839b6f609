"""Written by script/python-pages from what the module says of itself."""
from typing import Any, Iterator, Literal, Mapping, Optional, Sequence, Union, overload

import numpy

__version__: str

SceneKey = Literal[
    "phantom.name",
    "phantom.file",
    "phantom.voxel_mm",
    "phantom.gestational_age_weeks",
    "phantom.identity",
    "phantom.maternal_layer_mm",
    "phantom.mouth_open_mm",
    "phantom.head_pitch_deg",
    "phantom.head_yaw_deg",
    "phantom.head_roll_deg",
    "phantom.smile_mm",
    "phantom.tongue_mm",
    "phantom.lids_open_mm",
    "phantom.cleft_width_mm",
    "phantom.cleft_side",
    "phantom.cleft_alveolus_mm",
    "phantom.chin_back_deg",
    "phantom.jaw_shorter_mm",
    "phantom.nasal_bone_shorter_mm",
    "phantom.eyes_apart_mm",
    "phantom.bossing_mm",
    "phantom.ears_lower_deg",
    "phantom.hand",
    "phantom.hand_gap_mm",
    "phantom.cord",
    "phantom.cord_gap_mm",
    "phantom.placenta_mm",
    "phantom.radius_mm",
    "phantom.step_heights_mm",
    "phantom.thickness_mm",
    "phantom.point_echo_db",
    "phantom.tilt_x_deg",
    "phantom.tilt_y_deg",
    "phantom.unit_mm",
    "phantom.grids",
    "phantom.materials",
    "phantom.background",
    "phantom.target",
    "phantom.targets",
    "phantom.scatterers",
    "phantom.scatterers_gain_db",
    "placement.position_mm",
    "placement.rotation_deg",
    "motion.velocity_mm_s",
    "motion.turn_rate_deg_s",
    "motion.breath_amplitude_mm",
    "motion.breath_period_s",
    "motion.heartbeat_amplitude_mm",
    "motion.heartbeat_period_s",
    "motion.head_turn_deg",
    "motion.head_turn_period_s",
    "motion.head_axis",
    "motion.mouth_close_mm",
    "motion.mouth_period_s",
    "probe.preset",
    "probe.radius_mm",
    "probe.wobble_radius_mm",
    "probe.center_frequency_mhz",
    "probe.fractional_bandwidth",
    "probe.f_number",
    "probe.transmit_focus_mm",
    "probe.elements",
    "probe.pitch_mm",
    "probe.element_height_mm",
    "probe.elevation_focus_mm",
    "acquisition.depth_mm",
    "acquisition.sector_deg",
    "acquisition.fan_deg",
    "acquisition.sticks_per_frame",
    "acquisition.samples_per_stick",
    "acquisition.frames_per_volume",
    "acquisition.volumes",
    "acquisition.sound_speed_m_s",
    "acquisition.dead_time_us",
    "acquisition.focal_zones",
    "acquisition.fly_back_ms",
    "acquisition.motor",
    "simulation.preset",
    "simulation.fidelity",
    "simulation.seed",
    "simulation.threads",
    "simulation.speckle",
    "simulation.attenuation",
    "simulation.transmission_loss",
    "simulation.aperture_losses",
    "simulation.interface_echo",
    "simulation.side_lobes",
    "simulation.tissue_sound_speed",
    "simulation.apodisation",
    "simulation.scatterers_per_cell",
    "simulation.specular_width_deg",
    "simulation.noise_db",
    "simulation.tgc_db_per_cm_mhz",
    "simulation.full_scale_db",
    "simulation.dynamic_range_db",
    "simulation.low_pass",
    "simulation.output",
    "simulation.clutter.probe_reflection",
    "simulation.clutter.haze_db",
    "simulation.clutter.haze_reach_deg",
    "simulation.clutter.haze_trail_mm",
    "simulation.clutter.haze_fall_db_per_cm",
    "simulation.clutter.haze_unevenness_db",
    "simulation.clutter.particles_per_cm3",
    "simulation.clutter.particle_echo_db",
    "simulation.clutter.tissue_unevenness_db",
    "simulation.clutter.tissue_grain_mm",
    "simulation.clutter.even_skin_mm",
    "simulation.display.line_filter",
    "simulation.display.persistence",
    "simulation.display.grey_bits",
    "render.preset",
    "render.program",
    "render.program_voxel_mm",
    "render.program_timeout_s",
    "render.pipeline.mode",
    "render.pipeline.mid_volume",
    "render.reconstruction.sticks",
    "render.reconstruction.spacing_mm",
    "render.reconstruction.edge_level",
    "render.reconstruction.steepest_deg",
    "render.reconstruction.display_range_db",
    "render.scan_conversion.slice_size",
    "render.scan_conversion.filter_size",
    "render.scan_conversion.format",
    "render.volume_of_interest.center_mm",
    "render.volume_of_interest.size_mm",
    "render.view.yaw_deg",
    "render.view.pitch_deg",
    "render.view.roll_deg",
    "render.view.projection",
    "render.view.eye_distance_mm",
    "render.view.flip",
    "render.ray_casting.mode",
    "render.ray_casting.image_size",
    "render.ray_casting.steps",
    "render.ray_casting.kernel_3d",
    "render.ray_casting.kernel_space",
    "render.ray_casting.detector",
    "render.ray_casting.iso_level",
    "render.ray_casting.below_tissue_db",
    "render.ray_casting.incidence_correction_mm",
    "render.ray_casting.caps",
    "render.ray_casting.outline_mm",
    "render.ray_casting.smallest_piece_mm2",
    "render.ray_casting.buffer_length",
    "render.ray_casting.buffer_length_mm",
    "render.ray_casting.threshold",
    "render.ray_casting.threshold_per_sample",
    "render.ray_casting.edge",
    "render.ray_casting.window_2d",
    "render.ray_casting.refine_crossing",
    "render.ray_casting.stop_at_box",
    "render.ray_casting.stop_on_leaving_cone",
    "render.ray_casting.opacity_limit",
    "render.ray_casting.transfer_values",
    "render.ray_casting.transfer_opacity_per_mm",
    "render.ray_casting.transfer_grey",
    "render.shading.depth_filter_size",
    "render.shading.light",
    "render.shading.light_left_deg",
    "render.shading.light_up_deg",
    "render.shading.light_distance_mm",
    "render.shading.ambient",
    "render.shading.diffuse",
    "render.shading.specular",
    "render.shading.shininess",
    "render.shading.base",
    "render.shading.base_rgb",
    "render.shading.shadows",
    "render.shading.shadow_coefficient",
    "render.shading.shadow_bias_mm",
    "render.smoothing.filter",
    "render.smoothing.filter_size",
    "render.smoothing.range_sigma",
]
Settings = Union[Mapping[SceneKey, Any], Sequence[str], None]


class Error(Exception):
    """What the program would say in one line after "wobblebench: "."""


class BadInput(Error, ValueError):
    """Bad input, for which the program has exit code 2: a line that names file, key, value and what is allowed."""


class Failed(Error, RuntimeError):
    """What this machine cannot do, for which the program has exit code 1."""


class SceneWarning(UserWarning):
    """What the program would say after "wobblebench: warning: ", such as an option that was given and is without effect."""


class Scene:
    """What is scanned, by which probe, and how it is rendered: a file and settings, as the program takes them (docs/scenes.md). A scene does not change."""

    def __init__(self, file: str = '', settings: Settings = None) -> None:
        """`file`: TOML; empty: the defaults. `settings`: a dict of keys and values, or a list of texts "section.key=value". Raises BadInput."""

    def replace(self, settings: Settings) -> Scene:
        """The scene with other settings. Phantom and truth are not made again where they are the same. The scene of a board takes settings of [render] alone."""

    @property
    def options(self) -> dict[str, Any]:
        """Every option with its value, by sections, as `scene` of report.json. Makes the phantom, which says where it lies."""

    @property
    def given(self) -> set[str]:
        """Keys that the file and the settings named."""


def options() -> dict[str, Any]:
    """Every key of a scene: a dict of its type, what is allowed, and its default."""


class Frame:
    """One image plane of a volume, as it came from a board."""

    @property
    def samples(self) -> numpy.ndarray:
        """float32 [line, sample], log-compressed in [0, 1]. A view."""

    @property
    def arrived(self) -> numpy.ndarray:
        """bool [line]: False where the stick was lost, and its samples are 0. A view."""

    @property
    def volume(self) -> int:
        """Index, from 0."""

    @property
    def index(self) -> int:
        """Of the plane in the fan, from 0."""

    @property
    def ends_volume(self) -> bool:
        """No other frame of this volume follows."""


class Volume:
    """The samples of one sweep of the probe, in its polar coordinates (docs/units.md)."""

    @property
    def samples(self) -> numpy.ndarray:
        """float32 [frame, line, sample], log-compressed in [0, 1]. A view: what is written to it is rendered."""

    @property
    def arrived(self) -> numpy.ndarray:
        """bool [frame, line]: False where the stick was lost, and its samples are 0. A view."""

    @property
    def motor_angles_rad(self) -> numpy.ndarray:
        """[frame, line]: the motor's angle at each stick. A view."""

    @property
    def ranges_m(self) -> numpy.ndarray:
        """[sample]: distance from the probe's face along the stick."""

    @property
    def line_angles_rad(self) -> numpy.ndarray:
        """[line]: of the stick in the image plane."""

    @property
    def frame_angles_rad(self) -> numpy.ndarray:
        """[frame]: motor angle of the frame, by the plan."""

    @property
    def times_s(self) -> numpy.ndarray:
        """[frame, line]: when each stick is fired, by the plan; nan where that is not known."""

    @property
    def radius_m(self) -> float:
        """Radius of curvature of the probe's face."""

    @property
    def wobble_radius_m(self) -> float:
        """Distance of the wobble axis behind the face."""

    @property
    def index(self) -> int:
        """In the stream, from 0."""


class FrameIterator:
    """The frames of a board."""

    def __iter__(self) -> FrameIterator: ...

    def __next__(self) -> Frame: ...


class Board:
    """Iterates over the volumes of a board: the simulator, a recording, a card. It waits for its caller: only a card loses sticks to one that is slow, and counts them. Ctrl-C ends it."""

    def __init__(self, board: str = 'sim', scene: Optional[Scene] = None) -> None:
        """`board`: as --board takes it (docs/board.md). `scene`: what the simulator scans, or what a recording is compared with; without one the samples alone are read. Raises BadInput."""

    def __iter__(self) -> Board: ...

    def __next__(self) -> Volume:
        """The next volume."""

    def frames(self) -> FrameIterator:
        """Iterates over frames as they come."""

    def stop(self) -> None:
        """Ends the stream."""

    @property
    def scene(self) -> Optional[Scene]:
        """The scene with the board's probe, acquisition and display scale; None without one."""

    @property
    def account(self) -> Optional[dict]:
        """Sticks emitted, delivered and lost so far, by causes; None before the first volume."""


def simulate(scene: Scene) -> Volume:
    """The volume that the simulated probe makes of a scene of one volume. Raises BadInput."""


def find_head(volume: Volume) -> list[str]:
    """The settings that show the fetal head in a volume upright and whole, for Scene.replace(), as `run --frame` finds them. Raises BadInput where there is none."""


class Recording:
    """What a recording holds, and what is wrong with it; iterates over volumes."""

    def __init__(self, path: str) -> None:
        """Reads the whole file, as `wobblebench inspect`. Raises BadInput."""

    def board(self, scene: Optional[Scene] = None) -> Board:
        """A Board that reads it."""

    def __iter__(self) -> Board: ...

    @property
    def path(self) -> str: ...

    @property
    def bytes(self) -> int: ...

    @property
    def sticks(self) -> int:
        """That are intact and in order."""

    @property
    def lost(self) -> int:
        """Sticks that were emitted and are not here."""

    @property
    def volumes(self) -> int:
        """Of which a stick is there."""

    @property
    def acquisitions(self) -> int:
        """One after the other, each with settings of its own."""

    @property
    def complete(self) -> bool:
        """No stick is missing, and every volume that began is closed."""

    @property
    def damaged(self) -> bool:
        """Bytes were lost or changed, or cannot be read."""


class Picture:
    """What the renderer made of a volume."""

    @property
    def depth_m(self) -> numpy.ndarray:
        """float32 [row, column]: length of the pixel's ray from the view plane (parallel) or the eye (perspective) to the surface, NaN where there is none. A view."""

    @property
    def filtered_depth_m(self) -> numpy.ndarray:
        """float32 [row, column]: likewise, as it is shaded. A view."""

    @property
    def drawn(self) -> numpy.ndarray:
        """uint8 [row, column]: 1 where the surface was not found but continued (`render.ray_casting.outline_mm`); empty: all was found. A view."""

    @property
    def surface(self) -> numpy.ndarray:
        """float32 [row, column, 3]: shaded, linear RGB in [0, 1]. A view."""

    @property
    def volume(self) -> numpy.ndarray:
        """float32 [row, column, 3]: blended grey levels in [0, 1]. A view."""

    @property
    def camera(self) -> dict[str, Any]:
        """Matrices and conventions, as `camera` of report.json (docs/units.md)."""

    @property
    def passes_ms(self) -> dict[str, Any]:
        """Wall time of each pass."""


class Renderer:
    """The four-pass renderer in a context of its own, from any thread. Renderers of one process take turns."""

    def __init__(self, scene: Scene, gl: str = 'auto') -> None:
        """`gl`: as --gl takes it. Raises BadInput, and Failed for what this machine cannot render."""

    def render(self, volume: Optional[Volume] = None, scene: Optional[Scene] = None) -> Picture:
        """The picture of a volume; without one, of the last one. `scene`: other settings, by Scene.replace(); those of passes 2 to 4 do not make the slices anew."""

    @property
    def backend(self) -> str:
        """GL_RENDERER and GL_VERSION."""


class Truth:
    """The true surface of each pixel of a scene's picture."""

    @property
    def depth_m(self) -> numpy.ndarray:
        """float32 [row, column]: as Picture.depth_m, NaN where the probe can see no surface. A view."""

    @property
    def crossing_m(self) -> numpy.ndarray:
        """float32 [row, column]: depth of what the ray crosses first, seen or not. A view."""

    @property
    def normals(self) -> numpy.ndarray:
        """float32 [row, column, 3]: out of the tissue, probe frame. A view."""

    @property
    def reason(self) -> numpy.ndarray:
        """uint8 [row, column]: why the surface is seen or not: 0 nothing is crossed, 1 seen, 2 outside the field, 3 grazing, 4 shadowed. A view."""

    @property
    def part(self) -> numpy.ndarray:
        """uint8 [row, column]: label of the part that the ray crosses first (docs/labels.md); 0: none. A view."""

    @property
    def part_names(self) -> dict[str, Any]:
        """Names of the labels in `part`; empty for a phantom that names no parts."""


def truth(scene: Scene, volume: int = 0) -> Truth:
    """What a picture of this volume should show. Raises BadInput where it is not known."""


@overload
def score(picture: Picture, scene: Scene) -> dict[str, Any]:
    """Every measure of a picture against the truth of its scene, as `error` of report.json: a dict whose keys carry the unit. None: cannot be formed."""
@overload
def score(depth: numpy.ndarray, scene: Scene, unit: str = 'm', kind: str = 'ray', far: Optional[float] = None, volume: Optional[int] = None) -> dict[str, Any]:
    """The same of another renderer's depth map [row, column], as the command `score`: in `unit`, along the pixel's ray or as z of the camera (`kind`), NaN, 0 or less, and `far` or more where there is no surface. It is filtered and shaded as the scene says. `volume`: Volume.index of what was rendered; a scene that moves needs it."""
