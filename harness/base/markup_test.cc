#include "harness/base/markup.h"

#include <gtest/gtest.h>

namespace touchstone {
namespace {

TEST(Markup, TextCannotBecomeATagOrEndAnAttribute) {
  EXPECT_EQ(escape_xml("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; 'd'");
  EXPECT_EQ(escape_html("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(Markup, EverythingElseStaysAsItIs) {
  EXPECT_EQ(escape_html("20 \xC2\xB5m\n\t&amp;"), "20 \xC2\xB5m\n\t&amp;amp;") << "an entity is text like other text";
  EXPECT_EQ(escape_xml(""), "");
}

}  // namespace
}  // namespace touchstone
