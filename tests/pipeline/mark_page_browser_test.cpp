// Draws boxes on the page of `mark` in a headless Chromium. Skipped where Chromium is not installed
// (Debian: apt-get install chromium).
#include <gtest/gtest.h>

#include "pipeline/mark/mark_page.h"
#include "tests/support/browser.h"

namespace touchtrace {
namespace {

using testing::TemporaryFolder;

/// Answers of the program: two clips of a recording with 640x360 pixels. `saved` has what the page
/// posts.
constexpr const char* program = R"(<script>
  const emptyClip = (index) => ({ clip: index, object_name: "ball", first: 100 * index, last: 100 * index + 99,
                             frame: 100 * index, hand: null, object: null });
  const saved = [];
  window.fetch = async (path, request) => {
    if (path === "clips") return { json: async () => ({ width: 640, height: 360, clips: [emptyClip(0), emptyClip(1)] }) };
    saved.push(JSON.parse(request.body));
    return { ok: true, json: async () => ({}) };
  };
  HTMLCanvasElement.prototype.setPointerCapture = () => {};
</script><script>
"use strict";)";

/// Functions that draw like a user, in image pixels.
constexpr const char* user = R"(
  const at = (type, x, y) => {
    const area = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, bubbles: true,
      clientX: area.left + x * area.width / 640, clientY: area.top + y * area.height / 360 }));
  };
  const drag = (x0, y0, x1, y1) => { at("pointerdown", x0, y0), at("pointermove", x1, y1), at("pointerup", x1, y1); };
  const result = (value) => { document.body.dataset.result = JSON.stringify(value); };
)";

class MarkPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (testing::find_browser().empty()) GTEST_SKIP() << "no Chromium; the page is not run";
  }
  /// Value that `script` passes to result(), run after the page has its clips.
  std::string run(const std::string& script) {
    const std::string page = testing::replaced(std::string(mark_page().at("mark.html")),
                                               "<script>\n\"use strict\";", program);
    const auto loaded = testing::load(folder_, page, user + ("(async () => {" + script + "})();"));
    const std::string start = "data-result=\"";
    const auto from = loaded.dom.find(start);
    if (from == std::string::npos) return loaded.console;
    return loaded.dom.substr(from + start.size(),
                             loaded.dom.find('"', from + start.size()) - from - start.size());
  }
  TemporaryFolder folder_;
};

TEST_F(MarkPage, SavesDrawnBoxesOfAFrame) {
  EXPECT_EQ(run("step(7); drag(100, 50, 160, 90); drag(150, 80, 130, 60); await save();"
                "result([saved[0].clips[0].frame, saved[0].clips[0].hand, saved[0].clips[0].object,"
                " saved[0].clips.length])"),
            "[7,[100,50,60,40],[130,60,20,20],1]");
}

TEST_F(MarkPage, KeepsBoxesWhenTheImageIsClicked) {
  EXPECT_EQ(run("drag(100, 50, 160, 90); drag(130, 60, 150, 80); drag(300, 200, 301, 201); step(5);"
                "drag(300, 200, 301, 201); result([clip.frame, clip.hand, clip.object])"),
            "[0,[100,50,60,40],[130,60,20,20]]");
}

TEST_F(MarkPage, ReplacesBothBoxesInAnotherFrame) {
  EXPECT_EQ(run("drag(100, 50, 160, 90); drag(130, 60, 150, 80); step(5); drag(10, 20, 40, 60);"
                "result([clip.frame, clip.hand, clip.object, shown])"),
            "[5,[10,20,30,40],null,&quot;object&quot;]");
}

/// The slider and messages are seen without scrolling.
TEST_F(MarkPage, FitsIntoTheWindow) {
  EXPECT_EQ(run("const root = document.documentElement;"
                "result([root.scrollWidth <= innerWidth, root.scrollHeight <= innerHeight,"
                " canvas.getBoundingClientRect().width > 0.5 * innerWidth])"),
            "[true,true,true]");
}

}  // namespace
}  // namespace touchtrace
