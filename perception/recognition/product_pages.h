#pragma once

#include "perception/recognition/product_catalogue.h"

namespace loci::perception {

/// Whether there are saved web pages (.html, .htm) in a folder.
bool has_product_pages(const std::filesystem::path& folder);

/// Products of the web pages of a store that were saved with their images (§5.3), one per page, by the
/// pages' names. What a page says about itself as data counts first (JSON-LD and microdata of schema.org's
/// Product, Open Graph), then its heading, tables and definition lists. The image is the one that the data
/// names, or else the largest of the page, and is looked for below the folder, where browsers put it. Pages
/// without an image or a name are left out.
std::vector<Product> read_product_pages(const std::filesystem::path& folder);

}  // namespace loci::perception
