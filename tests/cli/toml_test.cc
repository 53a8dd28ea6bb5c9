#include "cli/toml.h"

#include "io/temporary_directory.h"
#include "support/prelude.h"

namespace mindahl::cli::toml_test {
namespace {

using Strings = std::vector<std::string>;

TEST(Toml, HasKeysWithStringsNumbersAndWords) {
  const auto items = ReadToml(
      "# a rig\n\nmodel = \"mindlin\"  # free\n[fit]\n  normal-load=50\n\"strict\" = true\n"
      "force = 'Load #1, \"raw\"'\r\nname = \"a \\\"b\\\" \\\\ c\"\nwindow = 3:5",
      "x.toml");
  ASSERT_EQ(items.size(), 6u);
  EXPECT_EQ(items[0].section, "");
  EXPECT_EQ(items[0].key, "model");
  EXPECT_EQ(items[0].values, Strings{"mindlin"});
  EXPECT_EQ(items[0].line, 3u);
  EXPECT_EQ(items[1].section, "fit");
  EXPECT_EQ(items[1].values, Strings{"50"});
  EXPECT_EQ(items[2].key, "strict");
  EXPECT_EQ(items[3].values, Strings{"Load #1, \"raw\""});
  EXPECT_EQ(items[4].values, Strings{"a \"b\" \\ c"});
  EXPECT_EQ(items[5].values, Strings{"3:5"});
}

TEST(Toml, HasArraysOnOneLineOrMany) {
  const Strings both = {"alpha=0.3", "force_offset=0"};
  for (const char* text :
       {"fix = [\"alpha=0.3\", \"force_offset=0\"]\n", "fix = ['alpha=0.3','force_offset=0',]",
        "fix = [\n  \"alpha=0.3\",\n  \"force_offset=0\"\n]\n",
        "fix = [ # two\n\n  \"alpha=0.3\", # Mindlin, [1]\n  \"force_offset=0\",\n]  # end\n",
        "fix = [\r\n\"alpha=0.3\"\r\n,\"force_offset=0\"]\r\n"}) {
    const auto items = ReadToml(std::string(text) + "\nnext = 1\n", "x.toml");
    ASSERT_EQ(items.size(), 2u) << text;
    EXPECT_EQ(items[0].values, both) << text;
    EXPECT_EQ(items[1].key, "next") << text;
  }
  EXPECT_EQ(ReadToml("loads = [1, 2.5e3]\n", "x.toml")[0].values, (Strings{"1", "2.5e3"}));
  EXPECT_TRUE(ReadToml("loads = []\n", "x.toml")[0].values.empty());
}

TEST(Toml, NamesFileAndLineOfAFault) {
  struct Fault {
    const char* text;
    const char* message;
  };
  for (const Fault& fault :
       {Fault{"a = 1\nfix = [\n\"b\",\n", "x.toml:2: the array opened here is never closed"},
        Fault{"a = 1\nb\n", "x.toml:2: 'b' is no option with its value"},
        Fault{"a =\n", "x.toml:1: a value is missing"},
        Fault{"a = \"b\nc = 1\n", "x.toml:1: a string is never closed"},
        Fault{"a = [1\n2]\n", "x.toml:2: a comma is missing before '2]'"},
        Fault{"a = [[1]]\n", "x.toml:1: '[' is no value"},
        Fault{"a = \"b\" c\n", "x.toml:1: unexpected 'c'"},
        Fault{"a = \"b\\n\"\n", "x.toml:1: '\\n' is no escape"},
        Fault{"\n[fit\n", "x.toml:2: '[fit' lacks its ']'"}}) {
    EXPECT_THAT(MessageOf<InputError>([&] { ReadToml(fault.text, "x.toml"); }),
                HasSubstr(fault.message));
  }
}

}  // namespace
}  // namespace mindahl::cli::toml_test
