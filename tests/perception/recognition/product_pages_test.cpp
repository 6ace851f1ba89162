#include "perception/recognition/product_pages.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/html_reader.h"
#include "perception/recognition/product_index.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Not;
using testing::Pair;

class ProductPages : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("loci_pages_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    make_folder(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    make_folder((folder_ / name).parent_path());
    write_file_atomically(folder_ / name, text);
  }
  void draw(const std::string& name, int width, int height) const {
    make_folder((folder_ / name).parent_path());
    mapping::write_image(folder_ / name, cv::Mat(height, width, CV_8UC3, cv::Scalar(20, 90, 200)));
  }
  Product only() const {
    const std::vector<Product> products = read_catalogue(folder_);
    EXPECT_EQ(products.size(), 1U);
    return products.at(0);
  }

  fs::path folder_;
};

TEST_F(ProductPages, DataForMachinesCountsFirst) {
  draw("milk_files/small milk.jpg", 100, 120);
  draw("milk_files/banner.jpg", 900, 200);
  write("milk.html", R"(<!DOCTYPE html><html><head><title>Milk - the shop</title>
    <script>var a = "<h1>no</h1>";</script>
    <script type="application/ld+json">{"@context": "https://schema.org", "@graph": [{"@type": "WebPage", "name": "no"},
      {"@type": "Product", "name": "Fresh Milk 1 l", "image": ["https://cdn.shop/x/small%20milk.jpg?w=300"],
       "description": "Whole milk. Keep refrigerated.", "brand": {"@type": "Brand", "name": "Arla"}, "gtin13": "7310865004703",
       "offers": {"@type": "Offer", "price": 1.29, "priceCurrency": "EUR"},
       "additionalProperty": [{"@type": "PropertyValue", "name": "Country of origin", "value": "Sweden"}]}]}</script></head>
    <body><img src="milk_files/banner.jpg"><h1>MILK!</h1>
    <table><tr><th>Ingredients:</th><td>milk &amp; vitamin&nbsp;D</td></tr><tr><td>Brand</td><td>other</td></tr></table>
    <dl><dt>Best before</dt><dd>10 days</dd></dl></body></html>)");
  const Product product = only();
  EXPECT_EQ(product.name, "Fresh Milk 1 l");
  EXPECT_EQ(product.image.filename(), "small milk.jpg");
  for (const auto& [key, value] : Properties{{"brand", "Arla"},
                                             {"barcode", "7310865004703"},
                                             {"price", "1.29 EUR"},
                                             {"origin", "Sweden"},
                                             {"ingredients", "milk & vitamin D"},
                                             {"shelf_life", "10 days"},
                                             {"volume", "1 l"},
                                             {"storage", "refrigerator"},
                                             {"perishable", "yes"}})
    EXPECT_THAT(product.properties, Contains(Pair(key, value)));
}

TEST_F(ProductPages, PagesWithoutDataAreReadByHeadingTablesAndTheLargestImage) {
  draw("tea_files/logo.png", 60, 60);
  draw("tea_files/tea.png", 300, 400);
  draw("tea_files/dot.png", 1, 1);
  write("tea.htm",
        "<html><head><meta charset='iso-8859-1'><title>Shop</title></head><body><img src=tea_files/dot.png>"
        "<img src='tea_files/logo.png'><IMG SRC=\"tea_files/tea.png\" alt=x><!-- <h1>old</h1> -->"
        "<h1>Gr\xfcner <b>Tee</b></h1><table><tr><td>Weight:</td><td>250 g</td></tr></table><p>unclosed");
  const Product product = only();
  EXPECT_EQ(product.name, "Grüner Tee");
  EXPECT_EQ(product.image.filename(), "tea.png");
  EXPECT_THAT(product.properties, Contains(Pair("weight", "250 g")));
}

TEST_F(ProductPages, MicrodataIsReadToo) {
  draw("a.png", 80, 80);
  write("a.html", R"(<div itemscope itemtype="http://schema.org/Product"><img itemprop="image" src="a.png">
    <span itemprop="name">Kaba</span><span itemprop="brand" itemscope><span itemprop="manufacturer">Mondelez</span></span>
    <meta itemprop="gtin13" content="4000000000006"><span itemprop="price" content="2.49">2,49</span></div>)");
  const Product product = only();
  EXPECT_EQ(product.name, "Kaba");
  EXPECT_THAT(product.properties, Contains(Pair("barcode", "4000000000006")));
  EXPECT_THAT(product.properties, Contains(Pair("manufacturer", "Mondelez")));
  EXPECT_THAT(product.properties, Contains(Pair("price", "2.49")));
}

TEST_F(ProductPages, PagesWithoutAImageAndImagesOutsideAreLeftOut) {
  draw("pages/in.png", 80, 80);
  draw("outside.png", 80, 80);
  write("pages/contact.html", "<title>Contact</title>");
  write("pages/thief.html", "<title>Thief</title><img src='../outside.png'>");
  write("pages/gone.html", "<title>Gone</title><img src='gone_files/x.png'>");
  EXPECT_THROW(read_catalogue(folder_ / "pages"), Error);
  write("pages/good.html", "<title>Good</title><img src='in.png'>");
  EXPECT_EQ(read_catalogue(folder_ / "pages").size(), 1U);
}

TEST_F(ProductPages, BrokenPagesAndImagesStopNobody) {
  write("a.html", "<");
  write("b.html", "<img src=\"b.png");
  write("b.png", "no image");
  write("c.html",
        "<script type='application/ld+json'>{\"@type\": [[[[</script><title>c</title><img "
        "src=c.png><td>&#xffffffff;&bogus;&");
  draw("c.png", 70, 70);
  EXPECT_EQ(only().name, "c");
}

TEST(HtmlReader, EntitiesBecomeText) {
  EXPECT_EQ(html_text("a &amp;&#228;&#xE4;&auml; b&nbsp; c &zzz; &"), "a &äää b c &zzz; &");
}

TEST(HtmlReader, DeeplyNestedPagesAreNotParsed) {
  std::string page;
  for (int i = 0; i < 1'000'000; ++i) page += "<b>";
  size_t tags = 0;
  const auto read = [&] {
    read_html(
        page, [&](const HtmlTag&) { ++tags; }, [](const std::string&) {});
  };
  read();
  EXPECT_EQ(tags, 0U);
  page.resize(3000);
  read();
  EXPECT_GT(tags, 1000U);
}

}  // namespace
}  // namespace loci::perception
