// What decides the truth changes the hash of the subject, and nothing else does.
#include "bench/scene/subject_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <type_traits>

#include "base/user_error.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

/// Changes the field of this number and no other.
class ChangeOne {
 public:
  explicit ChangeOne(int number) : number_(number) {}

  void real(std::string_view key, double& value, double unit, double, double) {
    if (chosen(key)) value += 1e-3 * unit;
  }
  void real_or_auto(
      std::string_view key, std::optional<double>& value, double unit, double, double) {
    if (chosen(key)) value = value.value_or(0) + 1e-3 * unit;
  }
  void reals(std::string_view key, std::vector<double>& values, double unit, double, double) {
    if (chosen(key)) values.push_back(unit);
  }
  void vec3(std::string_view key, glm::dvec3& values, double unit, double, double) {
    if (chosen(key)) values.z += 1e-3 * unit;
  }
  void integer(std::string_view key, int& value, int, int) {
    if (chosen(key)) ++value;
  }
  void seed(std::string_view key, std::uint64_t& value) {
    if (chosen(key)) ++value;
  }
  void flag(std::string_view key, bool& value) {
    if (chosen(key)) value = !value;
  }
  template <class Enum>
  void choice(std::string_view key,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> names) {
    if (chosen(key))
      value = value == names.begin()->second ? (names.end() - 1)->second : names.begin()->second;
  }
  void text(std::string_view key, std::string& value) {
    if (chosen(key)) value += "x";
  }
  void texts(std::string_view key, std::vector<std::string>& values) {
    if (chosen(key)) values.emplace_back("x");
  }
  void constant(std::string_view, std::string_view) {}

  const std::string& changed() const { return changed_; }

 private:
  bool chosen(std::string_view key) {
    if (next_++ != number_) return false;
    changed_ = key;
    return true;
  }
  int number_;
  int next_ = 0;
  std::string changed_;
};

/// Calls check(section, key, hash with that key changed) for each key of a scene.
template <class Check>
void for_each_changed_key(const Check& check) {
  std::vector<std::string> sections;
  Scene scene;
  for_each_section(scene, [&](const std::string& name, auto&) { sections.push_back(name); });
  for (const std::string& wanted : sections) {
    for (int number = 0;; ++number) {
      Scene other;
      ChangeOne change(number);
      for_each_section(other, [&](const std::string& name, auto& options) {
        if (name == wanted) describe(options, change);
      });
      if (change.changed().empty()) break;
      if (change.changed() == "scatterers") continue;  // a file, which must be there
      check(wanted, change.changed(), subject_hash(other));
    }
  }
}

/// Keys that decide what the default scene shows: a face at rest, whose surfaces are built in.
const std::vector<std::string> kOfTheFace = words_of(
    "name voxel_mm gestational_age_weeks identity maternal_layer_mm mouth_open_mm head_pitch_deg "
    "head_yaw_deg head_roll_deg smile_mm tongue_mm lids_open_mm cleft_width_mm chin_back_deg "
    "jaw_shorter_mm nasal_bone_shorter_mm eyes_apart_mm bossing_mm ears_lower_deg hand cord "
    "placenta_mm");
const std::vector<std::string> kOfItsMotion = words_of(
    "velocity_mm_s turn_rate_deg_s breath_amplitude_mm heartbeat_amplitude_mm head_turn_deg "
    "mouth_close_mm");

bool among(const std::vector<std::string>& keys, const std::string& key) {
  return std::ranges::find(keys, key) != keys.end();
}

TEST(SubjectHash, ChangesWithEveryKeyThatDecidesTheTruthAndWithNoOther) {
  const Scene defaults;
  const hw::SubjectHash before = subject_hash(defaults);
  EXPECT_TRUE(before.stated());
  int keys = 0;
  for_each_changed_key([&](const std::string& section, const std::string& key, const auto& hash) {
    SCOPED_TRACE(section + "." + key);
    ++keys;
    EXPECT_EQ(hash.phantom != before.phantom, section == "phantom" && among(kOfTheFace, key));
    EXPECT_EQ(hash.placement != before.placement, section == "placement");
    EXPECT_EQ(hash.motion != before.motion, section == "motion" && among(kOfItsMotion, key));
  });
  EXPECT_GT(keys, 80);
}

// Of a recording that an earlier commit (9cc7aa2) made of the default scene, whose face was
// another.
TEST(SubjectHash, OfTheDefaultFaceIsNotThatOfOlderRecordings) {
  const hw::SubjectHash hash = subject_hash(Scene());
  EXPECT_NE(hash.phantom, 2644393823U);
  EXPECT_EQ(hash.motion, 3743475150U);
}

hw::SubjectHash hash_with(const std::vector<std::string>& settings) {
  return subject_hash(load_scene({}, settings));
}

using Strings = std::vector<std::string>;

TEST(SubjectHash, IsOfTheBodyNotOfOptionsThatItsPhantomDoesNotUse) {
  const hw::SubjectHash ball = hash_with({"phantom.name=sphere"});
  for (const std::string& idle : words_of(
           "phantom.gestational_age_weeks=28 phantom.maternal_layer_mm=5 "
           "phantom.step_heights_mm=[4] phantom.tilt_x_deg=10 phantom.materials=['cortical_bone'] "
           "phantom.scatterers_gain_db=3 motion.breath_period_s=9 motion.head_axis=tilt")) {
    EXPECT_EQ(hash_with({"phantom.name=sphere", idle}), ball) << idle;
  }
  EXPECT_NE(hash_with({"phantom.name=sphere", "phantom.radius_mm=21"}), ball);
  EXPECT_NE(hash_with({"phantom.name=cyst"}), ball);
  const Strings breathing = {"phantom.name=sphere", "motion.breath_amplitude_mm=2"};
  EXPECT_NE(hash_with({breathing[0], breathing[1], "motion.breath_period_s=9"}),
            hash_with(breathing));
}

class ImportedSubject : public testing_support::FolderTest {
 protected:
  Scene scene_of(const std::string& name, const std::string& contents) {
    std::ofstream(file(name)) << contents;
    Scene scene;
    scene.phantom.name = "mesh";
    scene.phantom.file = file(name).string();
    return scene;
  }
};

TEST_F(ImportedSubject, IsTheFilesBytesNotItsName) {
  const auto hash = subject_hash(scene_of("a.obj", "v 1 2 3"));
  EXPECT_EQ(subject_hash(scene_of("b.obj", "v 1 2 3")), hash);
  EXPECT_NE(subject_hash(scene_of("a.obj", "v 1 2 4")).phantom, hash.phantom);
  const std::string large(200000, 'x');
  EXPECT_NE(subject_hash(scene_of("c.obj", large)), subject_hash(scene_of("d.obj", large + "y")));
  Scene missing;
  missing.phantom.name = "mesh";
  missing.phantom.file = file("none.obj").string();
  EXPECT_THROW(subject_hash(missing), UserError);
}

TEST_F(ImportedSubject, IsTheBytesOfTheListOfScatterersNotItsName) {
  const auto with_list = [&](const std::string& name, const std::string& contents) {
    std::ofstream(file(name)) << contents;
    Scene scene;
    scene.phantom.scatterers = file(name).string();
    return subject_hash(scene);
  };
  const auto hash = with_list("a.csv", "x_mm,y_mm,z_mm,amplitude\n0,0,50,1");
  const Scene defaults;
  EXPECT_NE(hash.phantom, subject_hash(defaults).phantom);
  EXPECT_EQ(with_list("b.csv", "x_mm,y_mm,z_mm,amplitude\n0,0,50,1"), hash);
  EXPECT_NE(with_list("a.csv", "x_mm,y_mm,z_mm,amplitude\n0,0,51,1").phantom, hash.phantom);
  Scene missing;
  missing.phantom.scatterers = file("none.csv").string();
  EXPECT_THROW(subject_hash(missing), UserError);
}

std::string refusal(const Scene& scene, const hw::SubjectHash& recorded, bool placed) {
  return refusal_of<UserError>(
      [&] { refuse_other_subject(scene, recorded, placed, "--board file=x"); });
}

// Commit 17478aa recorded `phantom.name=sphere phantom.gestational_age_weeks=28` with this hash.
TEST(OtherSubject, IsNotThatOfAnOlderRecordingWithTheSameOptions) {
  hw::SubjectHash recorded = hash_with({"phantom.name=sphere"});
  recorded.phantom = 1333695181U;
  const Scene same = load_scene({}, {"phantom.name=sphere", "phantom.gestational_age_weeks=28"});
  EXPECT_EQ(refusal(same, recorded, true), "");
  EXPECT_NE(refusal(load_scene({}, {"phantom.name=cyst"}), recorded, true), "");
}

TEST(OtherSubject, IsRefusedByTheSectionThatDiffers) {
  const Scene same;
  const hw::SubjectHash recorded = subject_hash(same);
  EXPECT_EQ(refusal(same, recorded, true), "");
  Scene face;
  face.phantom.gestational_age_weeks = 24;
  EXPECT_TRUE(refusal(face, recorded, false).starts_with("--board file=x: the scene's [phantom] "));
  EXPECT_EQ(refusal(face, hw::SubjectHash{}, true), "") << "the recording does not say";
  Scene moving;
  moving.motion.velocity_m_s = {0, 0, 1e-3};
  EXPECT_TRUE(holds(refusal(moving, recorded, false), "[motion]"));
  Scene beside;
  beside.placement.position_m.x = 1e-3;
  EXPECT_EQ(refusal(beside, recorded, false), "") << "not known before the phantom is built";
  EXPECT_TRUE(holds(refusal(beside, recorded, true), "[placement]"));
  beside.given.insert("placement.position_mm");
  EXPECT_TRUE(holds(refusal(beside, recorded, false), "[placement]"));
}

}  // namespace
}  // namespace wobblebench::bench
