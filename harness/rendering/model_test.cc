#include "harness/rendering/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/rendering/named_declaration.h"
#include "harness/rendering/parameters.h"
#include "harness/testing/error_message.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::rendering {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using touchstone::testing::message_of;

constexpr const char* model_text = R"({"schema": "touchstone-model/1",
 "renderer": "god-object",
 "parameters": {"stiffness_N_per_m": 600},
 "effects":    [{"name": "coulomb-friction", "parameters": {"mu_static": 0.3, "mu_dynamic": 0.25}}],
 "instrument": [{"name": "force-bias", "parameters": {"fx_N": 0.1, "fy_N": 0.0, "fz_N": -0.05}}]})";

TEST(Model, ReadsWhatTheFileSays) {
  const Model model = parse_model(model_text, "m.json");
  EXPECT_EQ(model.renderer, "god-object");
  EXPECT_EQ(model.parameters.at("stiffness_N_per_m"), 600.0);
  ASSERT_EQ(model.effects.size(), 1U);
  EXPECT_EQ(model.effects[0].name, "coulomb-friction");
  EXPECT_EQ(model.effects[0].place, "/effects/0");
  EXPECT_EQ(model.effects[0].parameters.at("mu_dynamic"), 0.25);
  ASSERT_EQ(model.instrument.size(), 1U);
  EXPECT_EQ(model.instrument[0].parameters.at("fz_N"), -0.05);
}

TEST(Model, WritesWhatItReadsBackToTheBit) {
  Model model = parse_model(model_text, "m.json");
  model.parameters["stiffness_N_per_m"] = 0.1 + 0.2;
  const Model again = parse_model(model_to_json(model), "again");
  EXPECT_EQ(again.parameters, model.parameters);
  EXPECT_EQ(again.effects[0].parameters, model.effects[0].parameters);
  EXPECT_EQ(model_to_json(again), model_to_json(model));
}

constexpr const char* with_picture = R"({"schema": "touchstone-model/1", "renderer": "god-object",
 "effects": [{"name": "height-image", "image": "pictures/hills.pgm"}]})";

// Wherever a model is written to, what it names is the same file.
TEST(Model, APictureIsNamedAsTheFolderOfTheModelSeesIt) {
  const testing::TemporaryFolder home;
  const auto at = home.path() / "models";
  std::filesystem::create_directories(at / "pictures");
  std::filesystem::create_directories(home.path() / "runs" / "first");
  write_file(at / "pictures" / "hills.pgm", "P2 1 1 1 1");
  write_file(at / "m.json", with_picture);
  const Model model = load_model(at / "m.json");
  EXPECT_EQ(read_file(model.effects[0].image), "P2 1 1 1 1");
  const auto other = home.path() / "runs" / "first" / "model.json";
  write_file(other, model_to_json(model, other.parent_path()));
  EXPECT_THAT(read_file(other), HasSubstr("\"../../models/pictures/hills.pgm\""));
  EXPECT_TRUE(std::filesystem::equivalent(load_model(other).effects[0].image, at / "pictures" / "hills.pgm"));
  // From inside of another document the folder is said, not guessed from what messages name.
  EXPECT_EQ(parse_model(with_picture, "case.json: /models/soft", at).effects[0].image, model.effects[0].image);
  // Through a link, ".." leads out of the folder that the link names.
  std::filesystem::create_directory_symlink(home.path() / "runs" / "first", home.path() / "latest");
  write_file(home.path() / "latest" / "again.json", model_to_json(model, home.path() / "latest"));
  EXPECT_EQ(read_file(load_model(home.path() / "latest" / "again.json").effects[0].image), "P2 1 1 1 1");
}

TEST(Model, TakesItsPicturesAlongAndOverwritesNone) {
  const testing::TemporaryFolder home;
  std::filesystem::create_directories(home.path() / "pictures");
  std::filesystem::create_directories(home.path() / "to");
  write_file(home.path() / "pictures" / "hills.pgm", "P2 1 1 1 1");
  Model model = parse_model(with_picture, "m.json", home.path());
  take_pictures_along(model, home.path() / "to");
  EXPECT_EQ(model.effects[0].image, home.path() / "to" / "hills.pgm");
  EXPECT_EQ(read_file(home.path() / "to" / "hills.pgm"), "P2 1 1 1 1");
  EXPECT_THAT(model_to_json(model, home.path() / "to"), HasSubstr("\"image\": \"hills.pgm\""));
  Model twice = parse_model(with_picture, "m.json", home.path());
  take_pictures_along(twice, home.path() / "to");  // the same picture: nothing to do
  write_file(home.path() / "to" / "hills.pgm", "P2 1 1 1 0");
  Model third = parse_model(with_picture, "m.json", home.path());
  EXPECT_THAT([&] { take_pictures_along(third, home.path() / "to"); },
              ::testing::ThrowsMessage<UsageError>(HasSubstr("another file")));
  EXPECT_EQ(read_file(home.path() / "to" / "hills.pgm"), "P2 1 1 1 0");
}

TEST(Model, RefusesWithThePlace) {
  const auto refused = [](std::string_view text) { return message_of([&] { parse_model(text, "m.json"); }); };
  EXPECT_THAT(refused(""), HasSubstr("m.json: is empty"));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/2","renderer":"x"})"), HasSubstr("/schema"));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1"})"), HasSubstr("\"renderer\" is missing"));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1","renderer":"x","parametres":{}})"), HasSubstr("parametres"));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1","renderer":"x","parameters":{"k":"6"}})"),
              AllOf(HasSubstr("/parameters/k"), HasSubstr("a number was expected")));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1","renderer":"x","parameters":{"k":1e999}})"),
              HasSubstr("m.json"));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1","renderer":"x","effects":[{"name":"a","mu":1}]})"),
              AllOf(HasSubstr("/effects/0"), HasSubstr("mu")));
  EXPECT_THAT(refused(R"({"schema":"touchstone-model/1","renderer":"x","effects":{"name":"a"}})"),
              HasSubstr("/effects"));
}

const std::vector<ParameterDeclaration> declared{{"stiffness_N_per_m", "N/m", 1.0, 1e6, 500.0, "spring"}};

TEST(Parameters, DefaultsAndValues) {
  EXPECT_EQ(Parameters(declared, {}, "renderer r", "m.json", "").at("stiffness_N_per_m"), 500.0);
  EXPECT_EQ(Parameters(declared, {{"stiffness_N_per_m", 7.0}}, "renderer r", "m.json", "").at("stiffness_N_per_m"),
            7.0);
  EXPECT_THROW((void)Parameters(declared, {}, "r", "m", "").at("other"), std::logic_error);
}

TEST(Parameters, UnreadAndOutOfRangeAreErrorsWithPlaceAndHelp) {
  const auto refused = [](const char* name, double value) {
    return message_of([&] { Parameters(declared, {{name, value}}, "renderer r", "m.json", "/effects/2"); });
  };
  EXPECT_THAT(refused("stifness_N_per_m", 7.0), AllOf(HasSubstr("m.json: /effects/2/parameters/stifness_N_per_m"),
                                                      HasSubstr("did you mean \"stiffness_N_per_m\"?")));
  EXPECT_THAT(refused("stiffness_N_per_m", 0.5), AllOf(HasSubstr("0.5 is out of range"), HasSubstr("N/m")));
  EXPECT_THAT(refused("stiffness_N_per_m", std::nan("")), HasSubstr("out of range"));
}

TEST(CheckEntry, FindsAnEntryAndSaysWhatAWrongNameWasMeantToBe) {
  const std::vector<NamedDeclaration> known{{"time-lag", "", {{"lag_s", "s", 0.0, 1.0, 0.0, "lag"}}}};
  const NamedParameters entry{"time-lag", {{"lag_s", 0.01}}, "/instrument/0"};
  EXPECT_EQ(check_entry(entry, known, "instrument entry", "m.json").at("lag_s"), 0.01);
  const NamedParameters wrong{"time-lagg", {}, "/instrument/0"};
  EXPECT_THAT(message_of([&] { check_entry(wrong, known, "instrument entry", "m.json"); }),
              AllOf(HasSubstr("/instrument/0/name"), HasSubstr("did you mean \"time-lag\"")));
}

}  // namespace
}  // namespace touchstone::rendering
