// Options that cannot change anything in a scene, because of the values that others have.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// Where the samples of a picture are from, and whether it is known what they show.
enum class SampleSource { simulator, recording_of_scene, unknown_subject };

struct IdleOption {
  std::string key;
  std::string acts_with;  ///< "render.view.projection = perspective"
};

/// Those of `given` that are without effect in the scene, but for what a report names.
std::vector<IdleOption> idle_options(const Scene& scene,
                                     const std::set<std::string>& given,
                                     SampleSource source = SampleSource::simulator);

/// Keys of [phantom] and [motion] that are without effect in the scene, whether given or not.
std::vector<std::string> idle_keys_of_subject(const Scene& scene);

/// "without effect in this scene: KEY (acts with …), …"; empty: there are none.
std::string idle_options_text(const std::vector<IdleOption>& options);

/// Options of several scenes, of which one is without effect if it is so in all that were given it.
class IdleInAll {
 public:
  void add(const Scene& scene, const std::set<std::string>& given);
  std::vector<IdleOption> options() const;

 private:
  std::vector<IdleOption> idle_;
  std::set<std::string> acting_;
};

}  // namespace wobblebench::bench
