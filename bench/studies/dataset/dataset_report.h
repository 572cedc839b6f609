// What a data set holds: the manifest, the contact sheet, and its page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/output_folder.h"
#include "bench/results/measure.h"
#include "bench/studies/dataset/dataset_scenes.h"

namespace wobblebench::bench {

/// The figures of one scene that its stratum's are made of.
struct SceneFigures {
  int index = 0;
  std::size_t stratum = 0;
  std::string refusal;              ///< empty: it was made
  bool measured = false;            ///< a picture was compared with a truth
  std::vector<double> values = {};  ///< of shown_figures(); NaN: not formed
  double bytes = 0;                 ///< of the files that the manifest has hashes of
};

/// The figures of scenes that the page shows.
Chosen shown_figures();

/// Stages manifest.jsonl, a line a scene in their order, and returns their figures. All scenes must
/// be there.
std::vector<SceneFigures> stage_manifest(const PopulationPlan& plan,
                                         const DatasetFolder& folder,
                                         OutputFolder& out);

/// Strata, refusals, and the scenes of the contact sheet. Stages the sheet and the pictures of its
/// scenes.
Document dataset_document(const PopulationPlan& plan,
                          const DatasetFolder& folder,
                          const std::vector<SceneFigures>& figures,
                          OutputFolder& out);

/// "dataset": scenes made and refused by stratum.
nlohmann::ordered_json dataset_json(const PopulationPlan& plan,
                                    const std::vector<SceneFigures>& figures);

}  // namespace wobblebench::bench
