#include "apart.h"

#include <cstdlib>
#include <stdexcept>

#include "support/prelude.h"

namespace mindahl::reliability::apart_test {
namespace {

std::vector<Ending> RunEach(std::size_t pieces, const ApartOptions& options,
                            const std::function<std::string(std::size_t)>& work) {
  std::vector<Ending> endings(pieces);
  RunApart(pieces, options, work,
           [&](std::size_t piece, const Ending& ending) { endings[piece] = ending; });
  return endings;
}

TEST(Apart, GivesEachPieceItsAnswer) {
  constexpr std::size_t kLongerThanAPipe = 200000;
  const auto endings = RunEach(5, {.at_once = 2}, [](std::size_t piece) {
    return std::string(kLongerThanAPipe, static_cast<char>('a' + piece));
  });
  for (std::size_t piece = 0; piece < endings.size(); ++piece) {
    EXPECT_EQ(endings[piece].answer, std::string(kLongerThanAPipe, static_cast<char>('a' + piece)));
  }
}

TEST(Apart, GoesOnAfterAPieceThatNeverReturns) {
  const auto endings = RunEach(2, {.seconds = 1}, [](std::size_t piece) -> std::string {
    volatile bool forever = piece == 0;
    while (forever) {
    }
    return "done";
  });
  EXPECT_FALSE(endings[0].answer);
  EXPECT_THAT(endings[0].fault, HasSubstr("not done after 1 s"));
  EXPECT_EQ(endings[1].answer, "done");
}

TEST(Apart, GoesOnAfterAPieceThatEndsTheProgramOrThrows) {
  const auto endings = RunEach(3, {}, [](std::size_t piece) -> std::string {
    if (piece == 0) std::abort();
    if (piece == 1) throw std::runtime_error("no such thing");
    return "done";
  });
  EXPECT_THAT(endings[0].fault, HasSubstr("ended the program"));
  EXPECT_EQ(endings[1].fault, "no such thing");
  EXPECT_EQ(endings[2].answer, "done");
}

}  // namespace
}  // namespace mindahl::reliability::apart_test
