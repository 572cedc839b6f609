#include "bench/python/scene.h"

#include <pybind11/stl.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/user_error.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/python/calls.h"

namespace wobblebench::python {

namespace {

using bench::ResolvedScene;
using bench::Scene;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostTruths = 8;

/// What the true surface of a pixel depends on.
std::string truth_key(const ResolvedScene& scene, std::uint32_t volume) {
  Json key = bench::resolved(scene.options());
  key["render"] = view_options(scene);
  return key.dump() + std::to_string(volume);
}

/// Lists every option as a dict: key, default, and what is allowed.
class OptionLister {
 public:
  OptionLister(std::string section, Json& options)
      : section_(std::move(section)), options_(options) {}

  void real(std::string_view key, double, double, double min, double max) {
    add(key, {{"type", "float"}, {"minimum", min}, {"maximum", max}});
  }
  void real_or_auto(
      std::string_view key, const std::optional<double>&, double, double min, double max) {
    add(key,
        {{"type", "float"}, {"minimum", min}, {"maximum", max}, {"choices", Json::array({kAuto})}});
  }
  void reals(std::string_view key, const std::vector<double>&, double, double min, double max) {
    add(key, {{"type", "list[float]"}, {"minimum", min}, {"maximum", max}});
  }
  void vec3(std::string_view key, const glm::dvec3&, double, double min, double max) {
    add(key, {{"type", "list[float]"}, {"length", 3}, {"minimum", min}, {"maximum", max}});
  }
  void integer(std::string_view key, int, int min, int max) {
    add(key, {{"type", "int"}, {"minimum", min}, {"maximum", max}});
  }
  void seed(std::string_view key, std::uint64_t) { add(key, {{"type", "int"}, {"minimum", 0}}); }
  void flag(std::string_view key, bool) { add(key, {{"type", "bool"}}); }
  void text(std::string_view key, const std::string&) { add(key, {{"type", "str"}}); }
  void texts(std::string_view key, const std::vector<std::string>&) {
    add(key, {{"type", "list[str]"}});
  }
  void constant(std::string_view, std::string_view) {}
  template <class Enum>
  void choice(std::string_view key,
              Enum,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    Json choices = Json::array();
    for (const auto& [name, unused] : names) choices.push_back(name);
    add(key, {{"type", "str"}, {"choices", choices}});
  }

 private:
  void add(std::string_view key, const Json& allowed) {
    options_[section_ + "." + std::string(key)] = allowed;
  }

  std::string section_;
  Json& options_;
};

py::dict options() {
  const Scene defaults = bench::load_scene({}, {});
  const Json values = bench::resolved(defaults);
  Json options = Json::object();
  bench::for_each_section(defaults, [&](const std::string& section, const auto& of_section) {
    OptionLister lister(section, options);
    describe(of_section, lister);
  });
  for (auto& [key, option] : options.items()) {
    std::string pointer = "/" + key;
    for (char& c : pointer) c = c == '.' ? '/' : c;
    option["default"] = values[Json::json_pointer(pointer)];
  }
  return from_json(options.dump());
}

std::string setting_text(const std::string& key, const py::handle& value) {
  if (value.is_none()) throw py::type_error(key + " = None: must have a value");
  // Numbers and arrays of NumPy as those of Python.
  const py::object plain = py::hasattr(value, "tolist") ? py::object(value.attr("tolist")())
                                                        : py::reinterpret_borrow<py::object>(value);
  return key + "=" + py::str(py::module_::import("json").attr("dumps")(plain)).cast<std::string>();
}

}  // namespace

Json view_options(const ResolvedScene& scene) {
  const Json all = bench::resolved(scene.options())["render"];
  return {
      {"view", all["view"]},
      {"volume_of_interest", all["volume_of_interest"]},
      {"ray_casting",
       {{"image_size", all["ray_casting"]["image_size"]}, {"edge", all["ray_casting"]["edge"]}}}};
}

SceneHandle::SceneHandle(std::string file, std::vector<std::string> settings)
    : file_(std::move(file)),
      settings_(std::move(settings)),
      given_(bench::load_scene(file_, settings_)) {}

SceneHandle::SceneHandle(const SceneHandle& given,
                         ResolvedScene resolved,
                         std::shared_ptr<Subject> subject)
    : file_(given.file_),
      settings_(given.settings_),
      given_(resolved.options()),
      is_of_board_(true),
      subject_(std::move(subject)),
      resolved_(std::move(resolved)) {}

ScenePointer SceneHandle::replaced(const std::vector<std::string>& settings) const {
  std::vector<std::string> all = settings_;
  all.insert(all.end(), settings.begin(), settings.end());
  auto made = std::make_shared<SceneHandle>(file_, std::move(all));
  made->subject_ = subject_;
  if (!is_of_board_) return made;
  for (const std::string& setting : settings) {
    if (setting.starts_with("render.")) continue;
    throw UserError("--set " + setting + ": must be of [render]: the rest is the board's");
  }
  Scene options = given_;
  options.given = made->given_.given;
  options.picture = made->given_.picture;
  options.render = made->given_.render;
  const auto& placed = resolved_->subject();
  made->resolved_ = bench::resolve_scene(std::move(options),
                                         placed ? std::optional(placed->phantom) : std::nullopt);
  made->given_ = made->resolved_->options();
  made->is_of_board_ = true;
  return made;
}

const ResolvedScene& SceneHandle::resolved() {
  const std::lock_guard lock(subject_->mutex);
  if (resolved_) return *resolved_;
  const auto progress = silent_progress();
  bench::warn_of_scene(given_, bench::SampleSource::simulator, *progress);
  const std::string made_of = bench::resolved(given_)["phantom"].dump();
  if (!subject_->phantom || subject_->made_of != made_of) {
    subject_->phantom = subject_->cache.phantom(given_.phantom);
    subject_->made_of = made_of;
  }
  resolved_ = bench::resolve_scene(given_, subject_->phantom);
  const std::lock_guard warning(warning_);
  warnings_ = progress->warnings();
  return *resolved_;
}

std::vector<std::string> SceneHandle::take_warnings() {
  const std::lock_guard lock(warning_);
  return std::exchange(warnings_, {});
}

std::shared_ptr<const bench::TrueView> SceneHandle::truth(std::uint32_t volume) {
  const ResolvedScene& scene = resolved();
  if (!scene.subject()) throw UserError("truth: what the samples are of is not known");
  const std::lock_guard lock(subject_->mutex);
  const std::string key = truth_key(scene, volume);
  const auto found = subject_->truths.find(key);
  if (found != subject_->truths.end()) return found->second;
  if (subject_->truths.size() >= kMostTruths) subject_->truths.clear();
  return subject_->truths[key] = std::make_shared<const bench::TrueView>(
             bench::true_surface(scene, subject_->maps, volume), scene.view().camera);
}

std::vector<std::string> settings_of(const py::object& settings) {
  std::vector<std::string> texts;
  if (settings.is_none()) return texts;
  try {
    if (!py::isinstance<py::dict>(settings)) return settings.cast<std::vector<std::string>>();
    for (const auto& [key, value] : settings.cast<py::dict>()) {
      texts.push_back(setting_text(key.cast<std::string>(), value));
    }
    return texts;
  } catch (const py::cast_error&) {
    throw py::type_error("settings must be a dict of keys and values, or a list of texts");
  }
}

void add_scene(py::module_& module) {
  const auto make = [](const std::string& file, const py::object& settings) {
    const auto texts = settings_of(settings);
    return refusing([&] { return std::make_shared<SceneHandle>(file, texts); });
  };
  const auto reduce = [](const SceneHandle& scene) {
    if (scene.is_of_board()) throw py::type_error("the scene of a board cannot be pickled");
    const auto file = scene.file().empty() ? "" : std::filesystem::absolute(scene.file()).string();
    return py::make_tuple(py::type::of<SceneHandle>(), py::make_tuple(file, scene.settings()));
  };
  py::class_<SceneHandle, ScenePointer>(module,
                                        "Scene",
                                        "What is scanned, by which probe, and how it is rendered: "
                                        "a file and settings, as the program "
                                        "takes them (docs/scenes.md). A scene does not change.")
      .def(py::init(make),
           py::arg("file") = "",
           py::arg("settings") = py::none(),
           "`file`: TOML; empty: the defaults. `settings`: a dict of keys and values, or a list of "
           "texts \"section.key=value\". Raises BadInput.")
      .def(
          "replace",
          [](const SceneHandle& scene, const py::object& settings) {
            const auto texts = settings_of(settings);
            return refusing([&] { return scene.replaced(texts); });
          },
          py::arg("settings"),
          "The scene with other settings. Phantom and truth are not made again where they are the "
          "same. The scene of a board takes settings of [render] alone.")
      .def("__reduce__", reduce, "For pickle and copy: the file is read again.")
      .def_property_readonly(
          "options",
          [](const ScenePointer& scene) {
            auto text =
                released([scene] { return bench::resolved(scene->resolved().options()).dump(); });
            issue_warnings(scene->take_warnings());
            return from_json(text);
          },
          "Every option with its value, by sections, as `scene` of report.json. Makes the phantom, "
          "which says where it lies.")
      .def_property_readonly(
          "given",
          [](const SceneHandle& scene) { return scene.given().given; },
          "Keys that the file and the settings named.");
  module.def("options",
             options,
             "Every key of a scene: a dict of its type, what is allowed, and its default.");
}

}  // namespace wobblebench::python
