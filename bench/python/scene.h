// A scene as Python holds it.
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/scene/resolved_scene.h"
#include "phantoms/phantom.h"
#include "sim/probe_simulator.h"

namespace wobblebench::python {

/// A phantom with all that is made of it once, for the scenes that differ in other things.
struct Subject {
  std::mutex mutex;  ///< of what follows, and held while it is used
  bench::PhantomCache cache = bench::open_phantom_cache(1000);
  sim::TissueMapSource maps = bench::kept_maps(cache.tissue_maps());
  std::optional<phantoms::Phantom> phantom;
  std::string made_of;                                                   ///< options of `phantom`
  std::map<std::string, std::shared_ptr<const bench::TrueView>> truths;  ///< by what they depend on
};

/// Immutable for Python: what is left open is filled in when it is needed.
class SceneHandle {
 public:
  /// Throws UserError.
  SceneHandle(std::string file, std::vector<std::string> settings);
  /// The scene of a board; `resolved` by it, with the phantom of `subject`.
  SceneHandle(const SceneHandle& given,
              bench::ResolvedScene resolved,
              std::shared_ptr<Subject> subject);

  /// The scene with other settings. Throws UserError; for the scene of a board also where they are
  /// not of [render].
  std::shared_ptr<SceneHandle> replaced(const std::vector<std::string>& settings) const;

  /// As the file and the settings give it.
  const bench::Scene& given() const { return given_; }
  const std::shared_ptr<Subject>& subject() const { return subject_; }
  const std::string& file() const { return file_; }
  const std::vector<std::string>& settings() const { return settings_; }
  bool is_of_board() const { return is_of_board_; }
  /// Makes the phantom. Takes Subject::mutex. Throws as commands do.
  const bench::ResolvedScene& resolved();
  /// Those of resolved(), once. Waits for no other call, as it is called with Python's lock.
  std::vector<std::string> take_warnings();
  /// The true surface in a volume. Takes Subject::mutex. Throws UserError where it is not known.
  std::shared_ptr<const bench::TrueView> truth(std::uint32_t volume);

 private:
  std::string file_;
  std::vector<std::string> settings_;
  bench::Scene given_;
  bool is_of_board_ = false;
  std::shared_ptr<Subject> subject_ = std::make_shared<Subject>();
  std::optional<bench::ResolvedScene> resolved_;
  std::mutex warning_;  ///< of warnings_
  std::vector<std::string> warnings_;
};

using ScenePointer = std::shared_ptr<SceneHandle>;

/// The options of [render] that the true surface of a pixel depends on, as resolved() has them.
nlohmann::ordered_json view_options(const bench::ResolvedScene& scene);

/// "section.key=value" of a list of such texts, or of a dict.
std::vector<std::string> settings_of(const pybind11::object& settings);

void add_scene(pybind11::module_& module);

}  // namespace wobblebench::python
