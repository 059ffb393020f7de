// The life of a golden: a result that failed is reviewed and accepted, and the case then passes with it.
#include "harness/golden/golden_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/check_tally.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "harness/testing/temporary_folder.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::golden {
using rendering::Model;
using rendering::RendererEntry;

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

class GoldenLife : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto source = std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / "plane-taps";
    std::filesystem::copy(source, golden() / "plane-taps", std::filesystem::copy_options::recursive);
  }
  std::filesystem::path golden() {
    std::filesystem::create_directories(folder_.path() / "golden");
    return folder_.path() / "golden";
  }
  std::filesystem::path out() { return folder_.path() / "out"; }
  bool passes(const ChangeModel& change = {}) {
    const Catalogues catalogues{renderers::built_in_catalogue(), synthetic::built_in_generators()};
    return check_case(catalogues, load_case(golden() / "plane-taps"), "god-object", {out(), false, change, {}})
        .passed();
  }
  testing::TemporaryFolder folder_;
};

void stiffer(Model& model) { model.parameters["stiffness_N_per_m"] *= 1.5; }

TEST_F(GoldenLife, WhatFailedIsReviewedAcceptedAndPassesFromThenOn) {
  ASSERT_TRUE(passes());
  EXPECT_THAT(chosen_pending(out(), {}, ""), IsEmpty());
  ASSERT_FALSE(passes(stiffer));
  const auto pending = chosen_pending(out(), {"plane-taps"}, "god-object");
  ASSERT_THAT(pending, SizeIs(1));
  EXPECT_THAT(chosen_pending(out(), {"another"}, ""), IsEmpty());
  EXPECT_THAT(chosen_pending(out(), {}, "penalty"), IsEmpty());
  EXPECT_THAT(review_text(pending, "golden", "out"),
              HasSubstr("touchstone golden accept plane-taps --model god-object --golden golden --out out"));
  EXPECT_EQ(accept_result(pending[0], golden(), out(), "a stiffer wall"), "replaced");
  EXPECT_EQ(read_provenance(golden() / "plane-taps" / "expected" / "god-object.h5").at("reason"), "a stiffer wall");
  EXPECT_THAT(chosen_pending(out(), {}, ""), IsEmpty()) << "what was accepted does not wait any more";
  EXPECT_TRUE(passes(stiffer));
  EXPECT_FALSE(passes()) << "the old answer is not the golden any more";
}

// Far inside the tolerance: nothing to say, unless bits were asked to be the same. Then it can be looked at and
// accepted.
TEST_F(GoldenLife, DriftThatWasAskedToFailIsReviewedAndAccepted) {
  const Catalogues catalogues{renderers::built_in_catalogue(), synthetic::built_in_generators()};
  const auto file = golden() / "plane-taps" / "expected" / "god-object.h5";
  const auto check = [&](const ChangeModel& change) {
    const GoldenCase taps = load_case(golden() / "plane-taps");
    return check_case(catalogues, taps, "god-object", {out(), false, change, {}, true});
  };
  // The golden of this very processor.
  ASSERT_FALSE(passes(stiffer));
  accept_result(chosen_pending(out(), {}, "")[0], golden(), out(), "of this processor");
  ASSERT_TRUE(check(stiffer).passed());
  const auto a_little = [](Model& model) {
    stiffer(model);
    model.parameters["stiffness_N_per_m"] *= 1.0 + 1e-12;
  };
  EXPECT_TRUE(passes(a_little));
  EXPECT_THAT(chosen_pending(out(), {}, ""), IsEmpty());
  const CheckResult drifted = check(a_little);
  EXPECT_FALSE(drifted.passed());
  EXPECT_TRUE(drifted.drift_fails);
  EXPECT_EQ(drifted.comparison.verdict, Verdict::equal);
  CheckTally tally;
  EXPECT_THAT(tally.add(load_case(golden() / "plane-taps"), "god-object", drifted, 0.1, {}),
              AllOf(HasSubstr("(drift, asked to fail)"), HasSubstr("left in")));
  EXPECT_EQ(tally.tests().at(0).verdict, "drift, asked to fail");
  const auto pending = chosen_pending(out(), {}, "");
  ASSERT_THAT(pending, SizeIs(1));
  EXPECT_EQ(accept_result(pending[0], golden(), out(), "another order of sums"), "replaced");
  EXPECT_EQ(read_provenance(file).at("reason"), "another order of sums");
  EXPECT_TRUE(check(a_little).passed());
}

TEST_F(GoldenLife, AModelThatTheCaseDoesNotHaveIsNotAccepted) {
  ASSERT_FALSE(passes(stiffer));
  auto pending = chosen_pending(out(), {}, "");
  pending[0].model = "nobody";
  EXPECT_THAT([&] { accept_result(pending[0], golden(), out(), "why"); },
              ThrowsMessage<UsageError>(HasSubstr("has no model nobody")));
}

TEST_F(GoldenLife, CasesAreChosenByNameOrFolder) {
  EXPECT_THAT(choose_cases(golden(), {}), SizeIs(1));
  EXPECT_EQ(choose_cases("nowhere", {(golden() / "plane-taps" / "").string()})[0].name, "plane-taps");
  EXPECT_THAT([&] { choose_cases(golden(), {"plane-tap"}); },
              ThrowsMessage<UsageError>(HasSubstr("there are: plane-taps")));
  EXPECT_EQ(usual_golden_folder(golden()), golden());
}

TEST_F(GoldenLife, AnExportedCaseIsTheCase) {
  const GoldenCase taps = load_case(golden() / "plane-taps");
  const auto to = folder_.path() / "exported";
  export_case(synthetic::built_in_generators(), taps, {"god-object"}, to);
  EXPECT_EQ(surface::load_mesh(to / "mesh.obj", 1.0).triangle_count(),
            case_mesh(synthetic::built_in_generators(), taps).triangle_count());
  EXPECT_EQ(recording::load_trajectory(to / "trajectory.csv").motion.t_s.size(),
            case_trajectory(synthetic::built_in_generators(), taps).motion.t_s.size());
  EXPECT_EQ(rendering::parse_model(read_file(to / "god-object.json"), "").renderer, "god-object");
  EXPECT_TRUE(std::filesystem::exists(to / "god-object.h5"));
  GoldenCase of_scene = taps;
  of_scene.scene = "{}";
  EXPECT_THAT([&] { export_case(synthetic::built_in_generators(), of_scene, {}, to); },
              ThrowsMessage<UsageError>(HasSubstr("a scene has no one mesh")));
}

// The picture lies in the case's folder, whichever folder the program runs in, and goes with what is exported.
TEST_F(GoldenLife, APictureOfAModelBelongsToTheCase) {
  const auto source = std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / "plane-stroke";
  std::filesystem::copy(source, golden() / "plane-stroke", std::filesystem::copy_options::recursive);
  const Catalogues catalogues{renderers::built_in_catalogue(), synthetic::built_in_generators()};
  GoldenCase stroke = load_case(golden() / "plane-stroke");
  EXPECT_TRUE(check_case(catalogues, stroke, "god-object-height-image", {out(), false, {}, {}}).passed());
  const auto to = folder_.path() / "exported";
  export_case(synthetic::built_in_generators(), stroke, {"god-object-height-image"}, to);
  const Model exported = rendering::load_model(to / "god-object-height-image.json");
  EXPECT_EQ(exported.effects[0].image, to / "hills.pgm");
  EXPECT_EQ(read_file(to / "hills.pgm"), read_file(source / "hills.pgm"));
  std::string& text = stroke.models.at("god-object-height-image");
  text.replace(text.find("hills.pgm"), 9, "../hills.pgm");
  EXPECT_THAT([&] { (void)case_model(stroke, "god-object-height-image"); },
              ThrowsMessage<BadData>(AllOf(HasSubstr("/models/god-object-height-image/effects/0/image"),
                                           HasSubstr("in the case's own folder"))));
}

// What a renderer declares that it cannot is no failure of it, and nothing else is skipped.
class DeclaredLimitations : public ::testing::Test {
 protected:
  static RendererEntry engine() {
    Model model;
    model.renderer = "god-object";
    return renderers::find_renderer(model);
  }
  CheckResult check(const std::string& name, const RendererEntry& entry) {
    const Catalogues catalogues{renderers::built_in_catalogue(), synthetic::built_in_generators()};
    const auto golden = std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden";
    const auto provided = std::make_shared<const RendererEntry>(entry);
    const ChangeModel change = [&](Model& model) { model.provided = provided; };
    return check_case(catalogues, load_case(golden / name), "god-object", {folder_.path(), false, change, {}});
  }
  testing::TemporaryFolder folder_;
};

TEST_F(DeclaredLimitations, ARunThatStartsInsideIsSkippedWithTheReason) {
  RendererEntry outside = engine();
  outside.cannot.push_back({rendering::Ability::start_inside, "the proxy starts where the tip is"});
  EXPECT_EQ(check("crease-concave", outside).skipped,
            "the run starts inside the body: the proxy starts where the tip is");
  const CheckResult approach = check("crease-concave-approach", outside);
  EXPECT_EQ(approach.skipped, "");
  EXPECT_TRUE(approach.passed()) << approach.table;
  EXPECT_EQ(check("crease-concave", engine()).skipped, "") << "nothing is declared";
  RendererEntry another = engine();
  another.cannot.push_back({rendering::Ability::ball_tip, "a point only"});
  EXPECT_EQ(check("crease-concave", another).skipped, "") << "it starts inside, and the tip is a point";
}

TEST_F(DeclaredLimitations, BodiesThatMoveAreSkippedForARendererOfOneObject) {
  RendererEntry of_one = engine();
  of_one.make_scene = nullptr;
  EXPECT_THAT(check("scene-ring", of_one).skipped, HasSubstr("takes one object, and the case has 2 that move"));
  EXPECT_EQ(check("scene-ring", engine()).skipped, "");
}

}  // namespace
}  // namespace touchstone::golden
