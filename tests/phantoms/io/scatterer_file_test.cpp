// A user's list beside a phantom, from CSV and HDF5, and through phantom.vdb and the cache's bytes.
#include "phantoms/io/scatterer_file.h"

#include <gtest/gtest.h>
#ifdef WOBBLEBENCH_HDF5
#include <hdf5.h>
#endif

#include <fstream>
#include <random>
#include <vector>

#include "phantoms/io/phantom_bytes.h"
#include "phantoms/phantom.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

class ScattererFile : public testing_support::FolderTest {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary | std::ios::trunc) << bytes;
  }
  PhantomOptions options(const std::string& name, double gain_db = 0) const {
    PhantomOptions options{.name = "sphere", .voxel_m = 2e-3};
    options.scatterers = file(name).string();
    options.scatterers_gain_db = gain_db;
    return options;
  }
  /// Without 'scatterers = "PATH": '.
  std::string refusal(const std::string& name) const {
    const std::string said = refusal_of<InvalidPhantom>([&] { validate(options(name)); });
    const std::string begin = "scatterers = \"" + file(name).string() + "\": ";
    EXPECT_TRUE(said.empty() || said.starts_with(begin)) << said;
    return said.substr(std::min(said.size(), begin.size()));
  }
};

constexpr char kTwo[] =
    "x_mm,y_mm,z_mm,amplitude,id,time_s\n1,2,3,-4,1,0\n2,2,3,-4,1,1\n5,6,7,8,2,0\n";

TEST_F(ScattererFile, IsBesideThePhantomThroughVdbAndCache) {
  write("two.csv", kTwo);
  const Phantom made = make_phantom(options("two.csv", -40));
  ASSERT_EQ(made.scatterers().size(), 2u);
  EXPECT_EQ(made.surfaces().size(), 1u);
  EXPECT_NEAR(made.scatterers().at(0, 0.5).position_m.x, 1.5e-3, 1e-15);
  EXPECT_NEAR(made.scatterers().at(0, 0.5).amplitude, -0.04, 1e-15);
  write_phantom(made, file("phantom.vdb"));
  EXPECT_EQ(read_phantom(file("phantom.vdb")).scatterers(), made.scatterers());
  EXPECT_EQ(phantom_from_bytes(to_bytes(made).value()).scatterers(), made.scatterers());
}

TEST_F(ScattererFile, OfAFileAreAddedToThoseOfItsPhantom) {
  write_phantom(make_phantom({.name = "points"}), file("points.vdb"));
  write("two.csv", kTwo);
  PhantomOptions both = options("two.csv", -40);
  both.name = "file";
  both.file = file("points.vdb").string();
  const std::size_t own = make_phantom({.name = "points"}).scatterers().size();
  EXPECT_EQ(make_phantom(both).scatterers().size(), own + 2);
}

TEST_F(ScattererFile, RefusalsNameTheFile) {
  write("empty.csv", "");
  write("bad.csv", "x_mm,y_mm,z_mm,amplitude\n1,2,3,4,5\n");
  write("list.txt", kTwo);
  std::filesystem::create_directory(file("folder.csv"));
  EXPECT_EQ(refusal("none.csv"), "no such file");
  EXPECT_EQ(refusal("empty.csv"), "is empty");
  EXPECT_EQ(refusal("folder.csv"), "is not a file");
  EXPECT_EQ(refusal("list.txt"), "must be a .csv or an .h5");
  EXPECT_EQ(refusal("bad.csv"),
            "line 2: has 5 values; must have 4, one a column, separated by commas");
}

#ifdef WOBBLEBENCH_HDF5

/// An HDF5 file that is being written.
class Hdf5 {
 public:
  explicit Hdf5(const std::filesystem::path& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Hdf5() { H5Fclose(file_); }
  Hdf5(const Hdf5&) = delete;
  Hdf5& operator=(const Hdf5&) = delete;

  void add(const std::string& name,
           const std::vector<double>& values,
           hid_t type = H5T_IEEE_F64LE,
           std::vector<hsize_t> shape = {}) const {
    if (shape.empty()) shape = {values.size()};
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    write(name, values, type, space, H5P_DEFAULT);
  }
  /// Larger than the file: nothing of it is written.
  void add_huge(const std::string& name) const {
    const hsize_t size = 1'000'000'000'000;
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 1000;
    H5Pset_chunk(creation, 1, &chunk);
    write(name, {}, H5T_IEEE_F64LE, H5Screate_simple(1, &size, nullptr), creation);
  }
  void add_external(const std::string& name, const std::string& other, hsize_t size) const {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(creation, other.c_str(), 0, size * sizeof(double));
    write(name, {}, H5T_IEEE_F64LE, H5Screate_simple(1, &size, nullptr), creation);
  }
  void add_link(const std::string& name, const std::string& other) const {
    H5Lcreate_external(other.c_str(), "/x_mm", file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  }
  void add_group(const std::string& name) const {
    H5Gclose(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  }

 private:
  void write(const std::string& name,
             const std::vector<double>& values,
             hid_t type,
             hid_t space,
             hid_t creation) const {
    const hid_t set =
        H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    if (!values.empty()) {
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Dclose(set);
    H5Sclose(space);
  }
  hid_t file_;
};

class ScattererHdf5 : public ScattererFile {
 protected:
  void SetUp() override { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

  /// With these columns and no others.
  void write_columns(const std::vector<std::string>& names) const {
    const Hdf5 out(file("list.h5"));
    for (const std::string& name : names) out.add(name, {1, 0});
  }
};

TEST_F(ScattererHdf5, GivesTheScatterersOfTheSameCsv) {
  write("two.csv", kTwo);
  {
    const Hdf5 out(file("two.h5"));
    out.add("x_mm", {1, 2, 5}, H5T_STD_I16BE);
    out.add("y_mm", {2, 2, 6}, H5T_IEEE_F32LE, {3, 1});
    out.add("z_mm", {3, 3, 7}, H5T_IEEE_F64BE, {1, 3});
    out.add("amplitude", {-4, -4, 8});
    out.add("id", {1, 1, 2}, H5T_STD_U8LE);
    out.add("time_s", {0, 1, 0});
    out.add_group("notes");
  }
  const auto points = read_scatterers(options("two.h5", -20));
  EXPECT_EQ(points.size(), 2u);
  EXPECT_EQ(points, read_scatterers(options("two.csv", -20)));
}

TEST_F(ScattererHdf5, RefusalsNameRowAndColumn) {
  write_columns({"x_mm", "y_mm", "z_mm"});
  EXPECT_EQ(refusal("list.h5"), "has no column amplitude");
  write_columns({"x_mm", "y_mm", "z_mm", "amplitude", "times_s"});
  EXPECT_EQ(
      refusal("list.h5"),
      "column \"times_s\": must be one of x_mm, y_mm, z_mm (or x_m, y_m, z_m), amplitude, id, "
      "time_s");
  {
    const Hdf5 out(file("list.h5"));
    for (const char* name : {"x_mm", "y_mm", "z_mm"}) out.add(name, {1, 2, 3});
    out.add("amplitude", {0, 0, 3});
  }
  EXPECT_EQ(refusal("list.h5").substr(0, 30), "row 3, column amplitude = 3: m");
  Hdf5(file("list.h5")).add("amplitude", {0}, H5T_IEEE_F64LE);
  EXPECT_EQ(refusal("list.h5"), "has no column x_mm");
}

TEST_F(ScattererHdf5, RefusesShapesTypesAndStorageOfOtherKinds) {
  const std::string of = "dataset \"x_mm\": ";
  Hdf5(file("list.h5")).add("x_mm", {1, 2, 3, 4}, H5T_IEEE_F64LE, {2, 2});
  EXPECT_EQ(refusal("list.h5"), of + "must have one dimension");
  Hdf5(file("list.h5")).add("x_mm", {}, H5T_C_S1, {4});
  EXPECT_EQ(refusal("list.h5"), of + "must hold numbers");
  Hdf5(file("list.h5")).add_huge("x_mm");
  EXPECT_EQ(refusal("list.h5"), of + "has more than 1000000 values");
  Hdf5(file("list.h5")).add_external("x_mm", "/etc/passwd", 4);
  EXPECT_EQ(refusal("list.h5"), of + "its values lie in other files");
  Hdf5(file("list.h5")).add_link("x_mm", "other.h5");
  EXPECT_EQ(refusal("list.h5"), "\"x_mm\": is a link, or has too long a name");
  {
    const Hdf5 out(file("list.h5"));
    out.add("amplitude", {1});
    out.add("x_mm", {1, 2});
  }
  EXPECT_EQ(refusal("list.h5"), "x_mm has another number of values than amplitude");
  write("list.h5", "x_mm,y_mm,z_mm,amplitude\n");
  EXPECT_EQ(refusal("list.h5"), "not a readable HDF5 file (it cannot be opened as one)");
}

TEST_F(ScattererHdf5, AFlippedBitIsALineOrAResult) {
  {
    const Hdf5 out(file("list.h5"));
    for (const char* name : {"x_mm", "y_mm", "z_mm", "amplitude"}) out.add(name, {0.1, 0.2, 0.3});
  }
  const std::string sound = testing_support::bytes_of(file("list.h5"));
  std::mt19937 random(25);
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    std::string damaged = sound;
    damaged[random() % sound.size()] ^= static_cast<char>(1 << random() % 8);
    write("list.h5", damaged);
    const std::string line = refusal("list.h5");
    EXPECT_FALSE(holds(line, "\n"));
    refused += !line.empty();
  }
  EXPECT_GT(refused, 0) << "none of these files is damaged: the test shows nothing";
}

#else

TEST_F(ScattererFile, WithoutHdf5ItsListsAreRefused) {
  write("list.h5", "\x89HDF\r\n\x1a\n");
  EXPECT_EQ(refusal("list.h5").substr(0, 31), "this build does not read HDF5, ");
}

#endif

}  // namespace
}  // namespace wobblebench::phantoms
