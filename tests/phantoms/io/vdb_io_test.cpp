// Phantoms written to and read from .vdb files, and the refusals of other files.
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <set>
#include <sstream>
#include <tuple>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

namespace fs = std::filesystem;

class VdbFile : public testing_support::FolderTest {
 protected:
  void SetUp() override { openvdb::initialize(); }

  fs::path file() const { return folder_ / "phantom.vdb"; }

  static Phantom small_phantom() {
    PhantomOptions options;
    options.name = "sphere";
    options.radius_m = 8e-3;
    options.voxel_m = 1e-3;
    return make_phantom(options);
  }

  std::string refusal() const {
    return refusal_of<InvalidPhantom>([&] { read_phantom(file()); });
  }

  // Reads the file, applies `change` and writes it again.
  void rewrite(const std::function<void(openvdb::GridPtrVec&, openvdb::MetaMap&)>& change) const {
    openvdb::io::File in(file().string());
    in.open(/*delayLoad=*/false);
    openvdb::GridPtrVec grids = *in.getGrids();
    openvdb::MetaMap meta = *in.getMetadata();
    in.close();
    change(grids, meta);
    openvdb::io::File(file().string()).write(grids, meta);
  }

  void expect_refusal(const std::string& words) const {
    const std::string line = refusal();
    EXPECT_EQ(line.rfind("file = \"" + file().string() + "\": ", 0), 0u) << line;
    EXPECT_TRUE(holds(line, words));
    EXPECT_FALSE(holds(line, "\n"));
  }
};

TEST_F(VdbFile, RoundTrip) {
  PhantomOptions options;
  options.voxel_m = 1.5e-3;
  const Phantom written = make_phantom(options);
  write_phantom(written, file());
  const Phantom read = read_phantom(file());
  EXPECT_EQ(read.name(), written.name());
  EXPECT_EQ(read.background(), written.background());
  EXPECT_EQ(read.region_of_interest().low, written.region_of_interest().low);
  EXPECT_EQ(read.region_of_interest().high, written.region_of_interest().high);
  EXPECT_EQ(read.suggested_position_m(), written.suggested_position_m());
  ASSERT_TRUE(read.joint() && written.joint());
  EXPECT_EQ(read.joint()->center_m, written.joint()->center_m);
  EXPECT_EQ(read.joint()->inner_m, written.joint()->inner_m);
  EXPECT_EQ(read.joint()->outer_m, written.joint()->outer_m);
  ASSERT_EQ(read.materials().size(), written.materials().size());
  for (std::size_t i = 0; i < read.materials().size(); ++i) {
    const Material &a = read.materials()[i], &b = written.materials()[i];
    EXPECT_EQ(std::tie(a.name, a.source), std::tie(b.name, b.source));
    EXPECT_EQ(std::tie(a.sound_speed_m_s, a.impedance_rayl, a.attenuation_db_per_cm_mhz),
              std::tie(b.sound_speed_m_s, b.impedance_rayl, b.attenuation_db_per_cm_mhz));
    EXPECT_EQ(std::tie(a.backscatter_db, a.roughness), std::tie(b.backscatter_db, b.roughness));
  }
  ASSERT_EQ(read.surfaces().size(), written.surfaces().size());
  for (std::size_t i = 0; i < read.surfaces().size(); ++i) {
    EXPECT_EQ(read.surfaces()[i].name, written.surfaces()[i].name);
    EXPECT_EQ(read.surfaces()[i].inside, written.surfaces()[i].inside);
    EXPECT_EQ(read.surfaces()[i].is_target, written.surfaces()[i].is_target);
    const auto &a = *read.grids().signed_distance[i], &b = *written.grids().signed_distance[i];
    EXPECT_EQ(a.transform(), b.transform());
    ASSERT_EQ(a.activeVoxelCount(), b.activeVoxelCount());
    const auto other = b.getConstAccessor();
    for (auto voxel = a.cbeginValueAll(); voxel; ++voxel) {
      ASSERT_EQ(*voxel, other.getValue(voxel.getCoord()));
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "no temporary is left";
}

TEST_F(VdbFile, KeepsAMouth) {
  const Phantom written = make_phantom({.voxel_m = 1.5e-3, .mouth_open_m = 6e-3});
  write_phantom(written, file());
  const std::optional<Mouth> read = read_phantom(file()).joint()->mouth;
  ASSERT_TRUE(read);
  const Mouth& mouth = *written.joint()->mouth;
  EXPECT_EQ(read->axes, mouth.axes);
  EXPECT_EQ(std::tie(read->center_m, read->opening_m, read->reach_m),
            std::tie(mouth.center_m, mouth.opening_m, mouth.reach_m));
  rewrite([](auto&, auto& meta) {
    meta.insertMeta("mouth_opening_m", openvdb::DoubleMetadata(-0.01));
  });
  expect_refusal("metadata \"mouth_opening_m\", axes and reach are not those of a mouth");
  rewrite([](auto&, auto& meta) { meta.removeMeta("mouth_opening_m"); });
  expect_refusal("has no metadata \"mouth_opening_m\"");
}

TEST_F(VdbFile, IsReadByName) {
  write_phantom(small_phantom(), file());
  PhantomOptions options;
  options.name = "file";
  options.file = file().string();
  EXPECT_EQ(make_phantom(options).name(), "sphere");
  EXPECT_FALSE(make_phantom(options).joint()) << "a sphere has no head";
}

TEST_F(VdbFile, RefusesAJointThatCannotTurn) {
  write_phantom(make_phantom({.voxel_m = 2e-3}), file());
  rewrite(
      [](auto&, auto& meta) { meta.insertMeta("joint_outer_m", openvdb::DoubleMetadata(0.01)); });
  expect_refusal("metadata \"joint_outer_m\" must be larger than \"joint_inner_m\"");
  rewrite([](auto&, auto& meta) { meta.removeMeta("joint_outer_m"); });
  expect_refusal("has no metadata \"joint_outer_m\"");
}

TEST_F(VdbFile, MaterialGridIsInPaintersOrder) {
  PhantomOptions options;
  options.voxel_m = 1e-3;
  const Phantom phantom = make_phantom(options);
  write_phantom(phantom, file());
  openvdb::io::File in(file().string());
  in.open();
  const auto materials = openvdb::gridPtrCast<FloatGrid>(in.readGrid("material"));
  ASSERT_TRUE(materials);
  const auto tree = materials->getConstAccessor();
  std::vector<FloatGrid::ConstAccessor> distances;
  for (const auto& grid : phantom.grids().signed_distance) {
    distances.push_back(grid->getConstAccessor());
  }
  std::set<int> met;
  for (int x = -80; x <= 80; x += 3) {
    for (int y = -90; y <= 110; y += 3) {
      for (int z = -69; z <= 110; z += 3) {
        int expected = phantom.background();
        for (std::size_t i = 0; i < distances.size(); ++i) {
          if (distances[i].getValue({x, y, z}) < 0) expected = phantom.surfaces()[i].inside;
        }
        ASSERT_EQ(int(tree.getValue({x, y, z})), expected) << x << " " << y << " " << z;
        met.insert(expected);
      }
    }
  }
  EXPECT_EQ(met.size(), 10u)
      << "mother's skin, fat, muscle, uterus; fluid, cord; fetal skin, skull, brain, eyes";
}

TEST_F(VdbFile, EqualPhantomsGiveEqualBytes) {
  const auto written = [&] {
    write_phantom(small_phantom(), file());
    std::ostringstream bytes;
    bytes << std::ifstream(file(), std::ios::binary).rdbuf();
    return bytes.str();
  };
  const std::string first = written();
  EXPECT_EQ(first, written());
  openvdb::io::File in(file().string());
  in.open();
  EXPECT_EQ(in.getUniqueTag().size(), 36u);
  EXPECT_EQ(in.getUniqueTag()[14], '8') << "a UUID of version 8";
}

TEST_F(VdbFile, ReadsFilesWithAnIntegerMaterialGrid) {
  write_phantom(small_phantom(), file());
  rewrite([](auto& grids, auto&) {  // as written until November 2026
    grids.back() = openvdb::Int32Grid::create(3);
    grids.back()->setName("material");
  });
  EXPECT_EQ(read_phantom(file()).name(), "sphere");
}

TEST_F(VdbFile, RefusesAMissingFile) {
  expect_refusal("no such file");
}

TEST_F(VdbFile, RefusesOtherFiles) {
  std::ofstream(file()) << "not an OpenVDB file";
  expect_refusal("not a readable OpenVDB file");
  std::ofstream(file(), std::ios::trunc);
  expect_refusal("not a readable OpenVDB file");
}

TEST_F(VdbFile, RefusesAVdbOfAnotherProgram) {
  openvdb::io::File(file().string()).write({openvdb::GridBase::createGrid(FloatGrid::gridType())});
  expect_refusal("not a phantom");
  expect_refusal("name = \"vdb\" imports level sets of others");
}

TEST_F(VdbFile, RefusesAMissingGrid) {
  write_phantom(small_phantom(), file());
  rewrite([](auto& grids, auto&) { grids.erase(grids.begin()); });
  expect_refusal("has no grid \"ball\"");
}

TEST_F(VdbFile, RefusesAWrongGridClass) {
  write_phantom(small_phantom(), file());
  rewrite([](auto& grids, auto&) { grids[0]->setGridClass(openvdb::GRID_FOG_VOLUME); });
  expect_refusal("not of the class level set");
}

TEST_F(VdbFile, RefusesAWrongGridType) {
  write_phantom(small_phantom(), file());
  rewrite([](auto& grids, auto&) {
    grids[0] = openvdb::GridBase::createGrid(openvdb::Int64Grid::gridType());
    grids[0]->setName("ball");
  });
  expect_refusal("no grid of floats or doubles");
}

TEST_F(VdbFile, RefusesNaN) {
  write_phantom(small_phantom(), file());
  rewrite([](auto& grids, auto&) {
    openvdb::gridPtrCast<FloatGrid>(grids[0])->tree().setValue(
        {8, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  });
  expect_refusal("not finite");
}

TEST_F(VdbFile, RefusesAMaterialBeyondTheTable) {
  write_phantom(small_phantom(), file());
  rewrite(
      [](auto&, auto& meta) { meta.insertMeta("surface.0.inside", openvdb::Int32Metadata(99)); });
  expect_refusal("surface.0.inside\" = 99: must be within 0");
}

TEST_F(VdbFile, RefusesMissingMetadata) {
  write_phantom(small_phantom(), file());
  rewrite([](auto&, auto& meta) { meta.removeMeta("material.2.roughness"); });
  expect_refusal("material.2.roughness");
}

TEST_F(VdbFile, RefusesALaterVersion) {
  write_phantom(small_phantom(), file());
  rewrite([](auto&, auto& meta) {
    meta.insertMeta("wobblebench_phantom_version", openvdb::Int32Metadata(2));
  });
  expect_refusal("wobblebench_phantom_version\" = 2");
}

TEST_F(VdbFile, RefusesEveryTruncation) {
  write_phantom(small_phantom(), file());
  const auto whole = fs::file_size(file());
  for (int tenth = 9; tenth >= 0; --tenth) {
    fs::resize_file(file(), whole * tenth / 10);
    EXPECT_NE(refusal(), "") << tenth << " tenths";
  }
}

TEST_F(VdbFile, NamesThePathThatCannotBeWritten) {
  const fs::path nowhere = folder_ / "no" / "such" / "folder.vdb";
  const std::string refusal =
      refusal_of<std::runtime_error>([&] { write_phantom(small_phantom(), nowhere); });
  EXPECT_TRUE(refusal.starts_with(nowhere.string() + ": ")) << refusal;
  fs::create_directory(file());
  EXPECT_THROW(write_phantom(small_phantom(), file()), std::runtime_error);
}

TEST_F(VdbFile, RefusesUnprintableText) {
  for (const std::string key :
       {"phantom", "surface.0.name", "material.1.name", "material.1.source"}) {
    for (const std::string text : {"\xff", "a\nb"}) {
      write_phantom(small_phantom(), file());
      rewrite([&](auto&, auto& meta) { meta.insertMeta(key, openvdb::StringMetadata(text)); });
      expect_refusal("metadata \"" + key + "\" is not printable UTF-8 text");
    }
  }
}

TEST_F(VdbFile, RemovesTheFileWhenTheDiskIsFull) {
  write_phantom(small_phantom(), file());
  const auto whole = fs::file_size(file());
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  auto* const before = std::signal(SIGXFSZ, SIG_IGN);
  for (const std::uintmax_t missing : {std::uintmax_t{1}, std::uintmax_t{100}, whole / 2, whole}) {
    rlimit limit = unlimited;
    limit.rlim_cur = whole - missing;
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string reason =
        refusal_of<std::runtime_error>([&] { write_phantom(small_phantom(), file()); });
    setrlimit(RLIMIT_FSIZE, &unlimited);
    EXPECT_EQ(reason.rfind(file().string() + ": ", 0), 0u) << reason;
    EXPECT_TRUE(fs::is_empty(folder_)) << "no partial file is left";
  }
  std::signal(SIGXFSZ, before);
}

}  // namespace
}  // namespace wobblebench::phantoms
