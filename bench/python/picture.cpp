// The renderer, its pictures, the truth and the score.
#include "bench/python/picture.h"

#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/user_error.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/exchange/surface/found_surface.h"
#include "bench/output/camera_matrices.h"
#include "bench/output/error_report.h"
#include "bench/python/arrays.h"
#include "bench/python/calls.h"
#include "bench/python/scan.h"
#include "bench/python/scene.h"
#include "bench/scene/subject_hash.h"
#include "hw/probe/motor_deviation.h"
#include "render/reference/reference.h"
#include "render/renderer.h"

namespace wobblebench::python {

namespace {

using Json = nlohmann::ordered_json;

/// A picture, and what its score depends on besides.
struct PictureData {
  render::Picture picture;
  std::uint32_t volume = 0;
  hw::MotorDeviation motor;  ///< of the volume's sticks
  std::string camera;        ///< JSON
  Json view = nullptr;       ///< view_options() of its scene; null: not known
  hw::SubjectHash subject;   ///< of the volume
};

using PicturePointer = std::shared_ptr<PictureData>;

/// OpenGL's entry points are one table for the process: one renderer works at a time.
std::mutex& gl_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// The driver's threads are not in a process that is forked from one that has rendered.
bool is_forked() {
  static const pid_t first = ::getpid();
  return ::getpid() != first;
}

void refuse_fork() {
  if (!is_forked()) return;
  throw std::runtime_error(
      "Renderer: this process was forked from one that had rendered, without its driver's threads; "
      "it must be started anew, as by multiprocessing.get_context(\"spawn\")");
}

/// A context that is current on the thread of a call, and on none between calls.
class RendererHandle {
 public:
  RendererHandle(ScenePointer scene, const std::string& backend) : scene_(std::move(scene)) {
    refuse_fork();
    scene_->resolved();
    const std::lock_guard lock(gl_mutex());
    context_ = render::make_context(backend);
    backend_ = context_->renderer_string();
    const ReleaseAtEnd current(*context_);
    remake(scene_->resolved());
  }

  ~RendererHandle() {
    // The last owner may be Python, or the thread of a call that Ctrl-C left.
    std::optional<py::gil_scoped_release> others_run;
    if (PyGILState_Check() == 1) others_run.emplace();
    if (is_forked()) {  // what would wait for those threads stays
      static_cast<void>(renderer_.release());
      static_cast<void>(context_.release());
      return;
    }
    const std::lock_guard lock(gl_mutex());
    if (!context_) return;
    const ReleaseAtEnd current(*context_);
    renderer_.reset();
  }

  RendererHandle(const RendererHandle&) = delete;
  RendererHandle& operator=(const RendererHandle&) = delete;

  PicturePointer render(const VolumePointer& volume, const ScenePointer& other) {
    refuse_fork();
    const ScenePointer& scene = other ? other : scene_;
    const bench::ResolvedScene& resolved = scene->resolved();
    const std::lock_guard lock(gl_mutex());
    const ReleaseAtEnd current(*context_);
    if (volume) {
      volume_ = std::make_unique<hw::PolarVolume>(volume->polar());
      subject_ = volume->subject;
      is_added_ = false;
    }
    if (!volume_) throw UserError("render: needs a volume: none was rendered before");
    take_settings(resolved);
    if (!is_added_) renderer_->add_volume(*volume_);
    is_added_ = true;
    auto data = std::make_shared<PictureData>();
    data->picture = renderer_->render();
    data->volume = volume_->volume_index();
    data->motor = hw::motor_deviation(*volume_);
    data->subject = subject_;
    data->view = view_options(resolved);
    data->camera = bench::camera_json(resolved.view().camera).dump();
    return data;
  }

  const std::string& backend() const { return backend_; }
  const ScenePointer& scene() const { return scene_; }

 private:
  struct ReleaseAtEnd {
    explicit ReleaseAtEnd(render::GlContext& of) : context(of) { context.make_current(); }
    ~ReleaseAtEnd() { context.release(); }
    ReleaseAtEnd(const ReleaseAtEnd&) = delete;
    ReleaseAtEnd& operator=(const ReleaseAtEnd&) = delete;
    render::GlContext& context;
  };

  void remake(const bench::ResolvedScene& scene) {
    renderer_.reset();
    renderer_ = std::make_unique<render::Renderer>(*context_, scene.plan(), scene.render());
    plan_ = scene.plan();
    is_added_ = false;
  }

  void take_settings(const bench::ResolvedScene& scene) {
    const auto same = [](const hw::AcquisitionPlan& a, const hw::AcquisitionPlan& b) {
      return a.probe() == b.probe() && a.acquisition() == b.acquisition();
    };
    if (!same(scene.plan(), volume_->plan())) {
      throw UserError("render: the volume was scanned by another plan than the scene's");
    }
    if (!same(*plan_, scene.plan()) || !renderer_->keeps_slices(scene.render())) {
      return remake(scene);
    }
    renderer_->set_options(scene.render());
  }

  ScenePointer scene_;
  std::unique_ptr<render::GlContext> context_;
  std::string backend_;
  std::unique_ptr<render::Renderer> renderer_;
  std::optional<hw::AcquisitionPlan> plan_;  ///< of renderer_
  std::unique_ptr<hw::PolarVolume> volume_;  ///< the last
  hw::SubjectHash subject_;                  ///< of the volume
  bool is_added_ = false;                    ///< renderer_ has it
};

using RendererPointer = std::shared_ptr<RendererHandle>;

void add_picture(py::module_& module) {
  const auto image = [](auto member) {
    return [member](const py::object& self) {
      return shown(self.cast<const PictureData&>().picture.*member, self);
    };
  };
  py::class_<PictureData, PicturePointer>(module, "Picture", "What the renderer made of a volume.")
      .def_property_readonly(
          "depth_m",
          image(&render::Picture::depth_m),
          "float32 [row, column]: length of the pixel's ray from the view plane (parallel) or the "
          "eye (perspective) to the surface, NaN where there is none. A view.")
      .def_property_readonly("filtered_depth_m",
                             image(&render::Picture::filtered_depth_m),
                             "float32 [row, column]: likewise, as it is shaded. A view.")
      .def_property_readonly("drawn",
                             image(&render::Picture::drawn),
                             "uint8 [row, column]: 1 where the surface was not found but continued "
                             "(`render.ray_casting.outline_mm`); empty: all was found. A view.")
      .def_property_readonly("surface",
                             image(&render::Picture::surface),
                             "float32 [row, column, 3]: shaded, linear RGB in [0, 1]. A view.")
      .def_property_readonly("volume",
                             image(&render::Picture::volume),
                             "float32 [row, column, 3]: blended grey levels in [0, 1]. A view.")
      .def_property_readonly(
          "camera",
          [](const PictureData& self) { return from_json(self.camera); },
          "Matrices and conventions, as `camera` of report.json (docs/units.md).")
      .def_property_readonly(
          "passes_ms",
          [](const PictureData& self) {
            py::dict times;
            for (const auto& pass : self.picture.passes) times[py::str(pass.name)] = pass.ms;
            return times;
          },
          "Wall time of each pass.");
}

void add_renderer(py::module_& module) {
  py::class_<RendererHandle, RendererPointer>(
      module,
      "Renderer",
      "The four-pass renderer in a context of its own, from any thread. Renderers of one process "
      "take turns.")
      .def(py::init([](const ScenePointer& scene, const std::string& gl) {
             auto made = released([=] { return std::make_shared<RendererHandle>(scene, gl); });
             issue_warnings(scene->take_warnings());
             return made;
           }),
           py::arg("scene"),
           py::arg("gl") = "auto",
           "`gl`: as --gl takes it. Raises BadInput, and Failed for what this machine cannot "
           "render.")
      .def(
          "render",
          [](const RendererPointer& renderer,
             const VolumePointer& volume,
             const ScenePointer& scene) {
            auto picture = released([=] { return renderer->render(volume, scene); });
            if (scene) issue_warnings(scene->take_warnings());
            return picture;
          },
          py::arg("volume") = nullptr,
          py::arg("scene") = nullptr,
          "The picture of a volume; without one, of the last one. `scene`: other settings, by "
          "Scene.replace(); those of passes 2 to 4 do not make the slices anew.")
      .def_property_readonly("backend", &RendererHandle::backend, "GL_RENDERER and GL_VERSION.");
}

/// Views of the truth's images keep the truth.
struct TruthData {
  std::shared_ptr<const bench::TrueView> view;
  const bench::Truth& truth() const { return view->truth; }
};

void add_truth(py::module_& module) {
  const auto image = [](auto member) {
    return [member](const py::object& self) {
      return shown(self.cast<const TruthData&>().truth().*member, self);
    };
  };
  py::class_<TruthData>(module, "Truth", "The true surface of each pixel of a scene's picture.")
      .def_property_readonly(
          "depth_m",
          image(&bench::Truth::depth_m),
          "float32 [row, column]: as Picture.depth_m, NaN where the probe can see "
          "no surface. A view.")
      .def_property_readonly(
          "crossing_m",
          image(&bench::Truth::crossing_m),
          "float32 [row, column]: depth of what the ray crosses first, seen or not. A view.")
      .def_property_readonly("normals",
                             image(&bench::Truth::normal),
                             "float32 [row, column, 3]: out of the tissue, probe frame. A view.")
      .def_property_readonly(
          "reason",
          [](const py::object& self) {
            const auto& kind = self.cast<const TruthData&>().truth().kind;
            return shown(reinterpret_cast<const std::uint8_t*>(kind.pixels.data()),
                         {kind.height, kind.width},
                         self);
          },
          "uint8 [row, column]: why the surface is seen or not: 0 nothing is crossed, 1 seen, 2 "
          "outside the field, 3 grazing, 4 shadowed. A view.")
      .def_property_readonly(
          "part",
          image(&bench::Truth::part),
          "uint8 [row, column]: label of the part that the ray crosses first (docs/labels.md); 0: "
          "none. A view.")
      .def_property_readonly(
          "part_names",
          [](const TruthData& data) {
            py::dict names;
            for (const auto& [label, name] : data.truth().parts) names[py::int_(label)] = name;
            return names;
          },
          "Names of the labels in `part`; empty for a phantom that names no parts.");
  module.def(
      "truth",
      [](const ScenePointer& scene, std::uint32_t volume) {
        auto data = released([=] { return TruthData{scene->truth(volume)}; });
        issue_warnings(scene->take_warnings());
        return data;
      },
      py::arg("scene"),
      py::arg("volume") = 0,
      "What a picture of this volume should show. Raises BadInput where it is not known.");
}

/// The truth of the picture's volume, without what its motor did not reach.
std::shared_ptr<const bench::TrueView> truth_of(const PictureData& picture, SceneHandle& scene) {
  auto view = scene.truth(picture.volume);
  const bench::ResolvedScene& resolved = scene.resolved();
  if (!picture.motor.matters(resolved.plan())) return view;
  bench::Truth truth = view->truth;
  bench::mark_outside(truth, picture.motor, resolved.plan().geometry(), view->camera);
  return std::make_shared<const bench::TrueView>(std::move(truth), view->camera);
}

/// Throws UserError where the picture is of another view or body than the scene.
void refuse_other_scene(const PictureData& picture, const bench::ResolvedScene& scene) {
  bench::refuse_other_subject(scene.options(), picture.subject, /*placed=*/true, "score");
  if (picture.view.is_null()) return;
  const Json made = picture.view.flatten(), here = view_options(scene).flatten();
  for (const auto& [place, value] : made.items()) {
    if (here.at(place) == value) continue;
    std::string key = "render" + place;
    std::ranges::replace(key, '/', '.');
    throw UserError("score: " + key + " = " + here.at(place).dump() +
                    " of the scene: the picture was made with " + value.dump());
  }
}

std::string score_picture(const PictureData& picture, SceneHandle& scene) {
  const bench::ResolvedScene& resolved = scene.resolved();
  refuse_other_scene(picture, resolved);
  const int size = resolved.view().camera.image_size;
  const auto& depth = picture.picture.depth_m;
  if (depth.width != size || depth.height != size) {
    throw UserError("score: a picture of " + std::to_string(depth.width) + " x " +
                    std::to_string(depth.height) + " pixels: render.ray_casting.image_size = " +
                    std::to_string(size) + " of the scene");
  }
  const auto view = truth_of(picture, scene);
  const auto measures = bench::measure_picture(picture.picture, *view, resolved.render());
  return bench::error_json(measures, bench::expected_surface(resolved)).dump();
}

using DepthArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The words for a depth map are those of the command `score`.
struct DepthMap {
  bench::DepthMapFile map;
  bench::SurfaceFileOptions options;
};

DepthMap depth_map(const DepthArray& depth,
                   const std::string& unit,
                   const std::string& kind,
                   std::optional<double> far) {
  if (depth.ndim() != 2) throw py::value_error("depth must be [row, column]");
  if (unit != "m" && unit != "mm") throw py::value_error("unit must be \"m\" or \"mm\"");
  if (kind != "ray" && kind != "z") throw py::value_error("kind must be \"ray\" or \"z\"");
  return {{.format = "array",
           .channel = "",
           .width = static_cast<int>(depth.shape(1)),
           .height = static_cast<int>(depth.shape(0)),
           .values = std::vector<double>(depth.data(), depth.data() + depth.size()),
           .mask = {}},
          {.file = "depth", .unit = unit, .kind = kind, .frame = "", .depths = {}, .far = far}};
}

/// Filtered and shaded as the scene says.
PictureData picture_of(const DepthMap& depth, const bench::ResolvedScene& scene) {
  try {
    auto found = bench::surface_of(depth.map, depth.options, scene.view());
    PictureData data;
    data.picture = render::shade_depth(found.depth_m, scene.render());
    data.picture.depth_m = std::move(found.depth_m);
    return data;
  } catch (const std::invalid_argument& error) {
    throw UserError(std::string("depth: ") + error.what());
  }
}

void add_score(py::module_& module) {
  module.def(
      "score",
      [](const PicturePointer& picture, const ScenePointer& scene) {
        return from_json(released([=] { return score_picture(*picture, *scene); }));
      },
      py::arg("picture"),
      py::arg("scene"),
      "Every measure of a picture against the truth of its scene, as `error` of report.json: a "
      "dict "
      "whose keys carry the unit. None: cannot be formed.");
  module.def(
      "score",
      [](const DepthArray& depth,
         const ScenePointer& scene,
         const std::string& unit,
         const std::string& kind,
         std::optional<double> far,
         std::optional<std::uint32_t> volume) {
        return from_json(released([map = depth_map(depth, unit, kind, far), scene, volume] {
          PictureData picture = picture_of(map, scene->resolved());
          if (!volume && scene->resolved().moves()) {
            throw UserError("score: volume is missing: the scene moves");
          }
          picture.volume = volume.value_or(0);
          return score_picture(picture, *scene);
        }));
      },
      py::arg("depth"),
      py::arg("scene"),
      py::arg("unit") = "m",
      py::arg("kind") = "ray",
      py::arg("far") = py::none(),
      py::arg("volume") = py::none(),
      "The same of another renderer's depth map [row, column], as the command `score`: in `unit`, "
      "along the pixel's ray or as z of the camera (`kind`), NaN, 0 or less, and `far` or more "
      "where there is no surface. It is filtered and shaded as the scene says. `volume`: "
      "Volume.index of what was rendered; a scene that moves needs it.");
}

}  // namespace

void add_pictures(py::module_& module) {
  add_picture(module);
  add_renderer(module);
  add_truth(module);
  add_score(module);
}

}  // namespace wobblebench::python
