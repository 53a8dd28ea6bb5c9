#include "cli/toml.h"

#include "support/prelude.h"

namespace mindahl::cli::toml_test {
namespace {

using Strings = std::vector<std::string>;

TEST(Toml, HasKeysWithStringsNumbersAndArraysInTheirOrder) {
  const auto items = ReadToml(
      "# a rig\n\nmodel = \"mindlin\"  # free\n[fit]\n  normal-load=50\n\"strict\" = true\n"
      "youngs-modulus-1 = 210e9\nfix = [ # two\n  'alpha=0.3',\n  \"force_offset=0\",\n]\r\n",
      "x.toml");
  ASSERT_EQ(items.size(), 5u);
  EXPECT_EQ(items[0].section, "");
  EXPECT_EQ(items[0].key, "model");
  EXPECT_EQ(items[0].values, Strings{"mindlin"});
  EXPECT_EQ(items[0].line, 3u);
  EXPECT_EQ(items[1].section, "fit");
  EXPECT_EQ(items[1].values, Strings{"50"});
  EXPECT_EQ(items[2].values, Strings{"true"});
  EXPECT_EQ(std::stod(items[3].values[0]), 210e9);
  EXPECT_EQ(items[4].values, (Strings{"alpha=0.3", "force_offset=0"}));
}

TEST(Toml, NamesFileAndLineOfAFault) {
  for (const auto& [text, place] : {std::pair("a = 1\nb = 3:5\n", "x.toml:2: "),
                                    {"a = 1\n\na = 2\n", "x.toml:3: "},
                                    {"[fit]\na = 1\n[fit]\n", "x.toml:3: "},
                                    {"a = \"open\n", "x.toml:1: "},
                                    {"a =\n", "x.toml:1: "},
                                    {"a = [1, [2]]\n", "x.toml:1: "},
                                    {"a = 2026-01-01\n", "x.toml:1: "}}) {
    SCOPED_TRACE(text);
    EXPECT_THAT([text = text] { ReadToml(text, "x.toml"); },
                ::testing::ThrowsMessage<InputError>(StartsWith(place)));
  }
}

}  // namespace
}  // namespace mindahl::cli::toml_test
