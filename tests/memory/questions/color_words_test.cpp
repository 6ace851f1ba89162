#include "memory/questions/names/color_words.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/base/text/text.h"

namespace loci::memory {
namespace {

std::string basic(const std::string& text) {
  std::vector<std::string> words = words_of(text);
  name_basic_colors(words);
  return joined(words, " ");
}

TEST(ColorWords, AreNamedByTheirBasicColour) {
  EXPECT_EQ(basic("the dark red mug"), "the red mug");
  EXPECT_EQ(basic("maroon mugs"), "red mugs");
  EXPECT_EQ(basic("a pale yellowish bowl"), "a yellow bowl");
  EXPECT_EQ(basic("is it navy or turquoise"), "is it blue or cyan");
}

TEST(ColorWords, OtherWordsStay) {
  for (const char* text : {"olive oil", "the light is on", "a dark mug", "orange juice"})
    EXPECT_EQ(basic(text), text);
}

TEST(ColorWords, AHueIsInItsColourOrSoFarFromIt) {
  EXPECT_EQ(degrees_from_color(50, "yellow"), 0);
  EXPECT_EQ(degrees_from_color(40, "yellow"), 2);
  EXPECT_EQ(degrees_from_color(355, "red"), 0);
  EXPECT_EQ(degrees_from_color(20, "red"), 6);
  EXPECT_EQ(degrees_from_color(340, "red"), 5);
  EXPECT_TRUE(std::isinf(degrees_from_color(50, "grey")));
}

TEST(ColorWords, WhatLightMakesOfOneAnotherIsSimilar) {
  EXPECT_TRUE(are_similar_colors("orange", "yellow"));
  EXPECT_TRUE(are_similar_colors("yellow", "orange"));
  EXPECT_FALSE(are_similar_colors("blue", "red"));
}

}  // namespace
}  // namespace loci::memory
