// All figures of something as a table of their own.
#pragma once

#include <cmath>

#include "bench/output/document/table.h"

namespace wobblebench::bench {

/// A row for each figure that is formed, each name once: its value, unit, and what it is.
inline Table figures_table(Table head, const Measurements& found) {
  head.columns = {{"figure"}, {"value", "value", "", 4, true}, {"unit"}, {"what"}};
  for (const MeasuredValue& one : found) {
    if (std::isnan(one.value) || found.find(one.name) != &one) continue;
    const Cell value = one.whole ? Cell(std::llround(one.value)) : Cell(one.value);
    head.add({Cell::code(one.name), value, unit_of(one.name).name, one.measure->help});
  }
  return head;
}

}  // namespace wobblebench::bench
