#include "bench/cache/phantom_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/scene/resolved_scene.h"
#include "phantoms/io/phantom_bytes.h"
#include "sim/probe_simulator.h"
#include "sim/tissue/tissue_map.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;

/// Changes the option of this number, as little as it can be.
class ChangeOne {
 public:
  explicit ChangeOne(int which) : which_(which) {}

  void real(std::string_view, double& value, double, double, double) {
    if (is_it()) value = std::nextafter(value, 1e9);
  }
  void reals(std::string_view, std::vector<double>& values, double, double, double) {
    if (is_it()) values.push_back(0);
  }
  void seed(std::string_view, std::uint64_t& value) {
    if (is_it()) ++value;
  }
  template <class Enum>
  void choice(std::string_view,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    if (is_it()) value = (names.end() - 1)->second;
  }
  void flag(std::string_view, bool& value) {
    if (is_it()) value = !value;
  }
  void text(std::string_view key, std::string& value) {
    if (is_it()) value = key == "name" ? "plane" : value + "x";
  }
  void texts(std::string_view, std::vector<std::string>& values) {
    if (is_it()) values.emplace_back();
  }
  int count() const { return at_; }

 private:
  bool is_it() { return at_++ == which_; }

  int which_;
  int at_ = 0;
};

TEST(PhantomKey, ChangesWithEveryOption) {
  const phantoms::PhantomOptions base{.name = "sphere"};
  std::set<std::string> keys = {phantom_key(base)};
  int options = 1;
  for (int which = 0; which < options; ++which) {
    phantoms::PhantomOptions changed = base;
    ChangeOne change(which);
    describe(changed, change);
    options = change.count();
    EXPECT_TRUE(keys.insert(phantom_key(changed)).second) << "option " << which;
  }
  EXPECT_GE(options, 16);
  EXPECT_EQ(phantom_key(base), phantom_key({.name = "sphere"}));
}

TEST(PhantomKey, KeepsListsApart) {
  const auto key = [](const std::vector<std::string>& grids) {
    return phantom_key({.name = "sphere", .grids = grids});
  };
  EXPECT_NE(key({"a", "b"}), key({"ab"}));
  EXPECT_NE(key({"a\n 1 b"}), key({"a", "b"}));
}

TEST(PhantomKey, OfAMapChangesWithItsReach) {
  EXPECT_NE(tissue_map_key("a", 1e-3), tissue_map_key("a", std::nextafter(1e-3, 1)));
  EXPECT_NE(tissue_map_key("a", 1e-3), tissue_map_key("b", 1e-3));
}

TEST(KeptMaps, AreMadeByOneThreadAtATime) {
  std::atomic<int> inside = 0, most = 0;
  const auto maps = kept_maps([&](const auto&...) {
    most = std::max(most.load(), ++inside);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    --inside;
    return nullptr;
  });
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 2e-3});
  {
    const std::jthread other([&] { maps(phantom, 1e-3, 1); }),
        another([&] { maps(phantom, 2e-3, 1); });
  }
  EXPECT_EQ(most, 1);
}

class PhantomCacheTest : public testing_support::FolderTest {
 protected:
  PhantomCacheTest() : blobs_(folder_ / "kept", 100000000) {}

  /// The tissue map that the cache gives of a phantom.
  std::string map_bytes(PhantomCache& cache, const phantoms::Phantom& phantom) {
    return sim::to_bytes(*cache.tissue_maps()(phantom, 2e-3, 0));
  }

  const phantoms::PhantomOptions options_{.name = "sphere", .voxel_m = 1e-3};
  BlobCache blobs_;
};

TEST_F(PhantomCacheTest, SecondTimeBothAreReadAndTheSame) {
  PhantomCache first(blobs_), second(blobs_), without;
  const auto made = first.phantom(options_);
  const std::string map = map_bytes(first, made);
  EXPECT_FALSE(first.kept().phantom || first.kept().tissue_map);
  const auto read = second.phantom(options_);
  EXPECT_EQ(map_bytes(second, read), map);
  EXPECT_TRUE(second.kept().phantom && second.kept().tissue_map);
  EXPECT_EQ(phantoms::to_bytes(read), phantoms::to_bytes(made));
  EXPECT_EQ(map_bytes(without, without.phantom(options_)), map);
  EXPECT_FALSE(without.kept().phantom || without.kept().tissue_map);
}

TEST_F(PhantomCacheTest, OtherOptionsAreAnotherPhantom) {
  PhantomCache cache(blobs_);
  cache.phantom(options_);
  cache.phantom({.name = "sphere", .voxel_m = 1e-3, .radius_m = 21e-3});
  EXPECT_FALSE(cache.kept().phantom);
  cache.phantom(options_);
  EXPECT_TRUE(cache.kept().phantom);
}

TEST_F(PhantomCacheTest, ADamagedEntryIsMadeAnew) {
  PhantomCache cache(blobs_);
  const auto made = cache.phantom(options_);
  const fs::path path = blobs_.path_of(phantom_key(options_));
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-1, std::ios::end);
    file.put('\x55');
  }
  const auto again = cache.phantom(options_);
  EXPECT_FALSE(cache.kept().phantom);
  EXPECT_EQ(phantoms::to_bytes(again), phantoms::to_bytes(made));
  cache.phantom(options_);
  EXPECT_TRUE(cache.kept().phantom);
}

TEST_F(PhantomCacheTest, AWholeEntryThatIsNoPhantomIsMadeAnew) {
  blobs_.store(phantom_key(options_), "whole, and no phantom");
  PhantomCache cache(blobs_);
  EXPECT_EQ(cache.phantom(options_).name(), "sphere");
  EXPECT_FALSE(cache.kept().phantom);
}

TEST_F(PhantomCacheTest, AListOfScatterersIsKnownByItsContent) {
  const fs::path path = file("list.csv");
  phantoms::PhantomOptions listed = options_;
  listed.scatterers = path.string();
  EXPECT_EQ(phantom_key(listed), "") << "there is no such file";
  const auto depth_of = [&](PhantomCache& cache, const char* z_mm) {
    std::ofstream(path) << "x_mm,y_mm,z_mm,amplitude\n0,0," << z_mm << ",1\n";
    return cache.phantom(listed).scatterers().at(0, 0).position_m.z;
  };
  PhantomCache cache(blobs_);
  cache.phantom(options_);
  EXPECT_DOUBLE_EQ(depth_of(cache, "50"), 50e-3);
  EXPECT_FALSE(cache.kept().phantom);
  EXPECT_DOUBLE_EQ(depth_of(cache, "50"), 50e-3);
  EXPECT_TRUE(cache.kept().phantom);
  EXPECT_DOUBLE_EQ(depth_of(cache, "51"), 51e-3);
  EXPECT_FALSE(cache.kept().phantom);
}

TEST_F(PhantomCacheTest, AnImportedFileIsKnownByItsContent) {
  const fs::path path = file("body.stl");
  const auto write_tetrahedron = [&](double mm) {
    std::ofstream stl(path);
    const double corners[4][3] = {{0, 0, 0}, {mm, 0, 0}, {0, mm, 0}, {0, 0, mm}};
    const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    stl << "solid t\n";
    for (const auto& face : faces) {
      stl << "facet normal 0 0 0\nouter loop\n";
      for (const int at : face) {
        stl << "vertex " << corners[at][0] << " " << corners[at][1] << " " << corners[at][2]
            << "\n";
      }
      stl << "endloop\nendfacet\n";
    }
    stl << "endsolid t\n";
  };
  const phantoms::PhantomOptions options{.name = "mesh", .file = path.string(), .voxel_m = 1e-3};
  PhantomCache cache(blobs_);
  write_tetrahedron(40);
  const auto made = phantoms::to_bytes(cache.phantom(options));
  ASSERT_TRUE(made) << "a mesh's phantom can be kept";
  EXPECT_EQ(phantoms::to_bytes(cache.phantom(options)), made);
  EXPECT_TRUE(cache.kept().phantom);
  write_tetrahedron(41);
  EXPECT_NE(phantoms::to_bytes(cache.phantom(options)), made);
  EXPECT_FALSE(cache.kept().phantom);
}

TEST_F(PhantomCacheTest, EchoesAreThoseOfTheirSceneWhateverIsRendered) {
  const auto scanned = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> all = {"phantom.name=sphere",
                                    "phantom.voxel_mm=2",
                                    "acquisition.frames_per_volume=5",
                                    "acquisition.sticks_per_frame=9",
                                    "simulation.seed=3"};
    all.insert(all.end(), settings.begin(), settings.end());
    const Scene given = load_scene({}, all);
    PhantomCache cache(blobs_);
    const ResolvedScene scene = resolve_scene(given, cache.phantom(given.phantom));
    const auto volume = [&](const sim::EchoStore& echoes) {
      return sim::ProbeSimulator(*scene.subject(), scene.plan(), scene.simulation(), {}, echoes)
          .volume(1);
    };
    EXPECT_EQ(volume(cache.echoes(scene)), volume({}));
    return cache.kept().echoes;
  };
  EXPECT_FALSE(scanned({}));
  EXPECT_TRUE(scanned({}));
  EXPECT_TRUE(scanned({"render.view.yaw_deg=10", "render.preset=baseline"}));
  for (const char* other : {"simulation.seed=4",
                            "simulation.fidelity=scatterers",
                            "simulation.clutter.haze_db=-10",
                            "probe.preset=c5-2v",
                            "acquisition.depth_mm=150",
                            "placement.position_mm=[1, 0, 110]",
                            "phantom.radius_mm=25"}) {
    EXPECT_FALSE(scanned({other})) << other;
    EXPECT_TRUE(scanned({other})) << other;
  }
  // Each volume of a motion has echoes of its own.
  EXPECT_FALSE(scanned({"motion.velocity_mm_s=[5, 0, 0]"}));
  EXPECT_FALSE(scanned({"motion.velocity_mm_s=[5, 0, 0]"}));
}

TEST_F(PhantomCacheTest, RefusesAsWithoutACache) {
  PhantomCache cache(blobs_);
  EXPECT_THROW(cache.phantom({.name = "sphere", .radius_m = 0}), std::invalid_argument);
  EXPECT_THROW(cache.phantom({.name = "mesh", .file = file("none.stl").string()}),
               phantoms::InvalidPhantom);
}

}  // namespace
}  // namespace wobblebench::bench
