#include "mindahl/models/friction_model.h"

#include "support/prelude.h"

namespace mindahl::models::friction_model_test {
namespace {

TEST(FrictionModels, AreFoundByTheNamesOfTheCommandLine) {
  for (const std::string_view name : {"mindlin-dahl", "mindlin", "jenkins", "dahl"}) {
    const FrictionModel* model = FindFrictionModel(name);
    ASSERT_NE(model, nullptr) << name;
    EXPECT_EQ(model->name, name);
  }
  EXPECT_EQ(FindFrictionModel("Mindlin"), nullptr);
  EXPECT_EQ(FindFrictionModel(""), nullptr);
}

TEST(FrictionModels, PrescribeTheShapeExponentWhereTheNameDoes) {
  EXPECT_EQ(FindFrictionModel("mindlin")->shape_exponent, 1.0 / 3.0);
  EXPECT_EQ(FindFrictionModel("jenkins")->shape_exponent, 0.0);
  EXPECT_FALSE(FindFrictionModel("mindlin-dahl")->shape_exponent.has_value());
  EXPECT_FALSE(FindFrictionModel("dahl")->shape_exponent.has_value());
}

}  // namespace
}  // namespace mindahl::models::friction_model_test
