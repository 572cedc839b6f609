#include "sim/stick_order.h"

#include <gtest/gtest.h>

#include <set>

namespace wobblebench::sim {
namespace {

TEST(StickOrder, TakesEachStickOnce) {
  for (const int frames : {1, 15, 16, 17, 37}) {
    for (const int lines : {1, 5}) {
      for (const std::uint32_t volume : {0u, 1u}) {  // an odd volume sweeps back
        const hw::AcquisitionPlan plan({},
                                       {.sticks_per_frame = lines,
                                        .frames_per_volume = frames,
                                        .motor = hw::MotorMode::alternating});
        std::set<std::uint64_t> sequences;
        for (int i = 0; i < frames * lines; ++i) {
          sequences.insert(plan.sequence(stick_in_order(plan, volume, i)));
        }
        ASSERT_EQ(sequences.size(), static_cast<std::size_t>(frames * lines));
        EXPECT_EQ(*sequences.begin(), plan.first_sequence(volume));
        EXPECT_EQ(*sequences.rbegin() + 1, plan.first_sequence(volume + 1));
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
