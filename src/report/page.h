// A report as one self-contained HTML page.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/pictures.h"

namespace trilens {

using Facts = std::vector<std::pair<std::string, std::string>>;

/// A page around `body` (markup). The title is text.
std::string html_page(const std::string& title, const std::string& body);

/// A row of pictures with captions and the meaning of their colours. Two that show the same lie one over the
/// other with a slider between them, for mouse, finger and keys; a click, a tap or Enter shows full size.
/// Without scripts all lie side by side.
std::string html_pictures(const std::vector<PagePicture>& pictures);

/// A row of pictures whose first two show the same: the second is exchanged for the first under the pointer,
/// with the key F all over the page, and by a button, for fingers. Without scripts all stand still side by
/// side. Pictures without PNG bytes are captions.
std::string html_flip(const PagePicture& first, const PagePicture& second,
                      const std::vector<PagePicture>& others);

/// A two-column list.
std::string html_facts(const Facts& facts);

/// A table; every row has as many cells as there are columns. All is text. With scripts a click on a column's
/// head sorts by it, and of eight rows and more a field shows those that hold the words typed there.
std::string html_table(const std::vector<std::string>& columns,
                       const std::vector<std::vector<std::string>>& rows);

/// One element around text: html_text("h2", "Runs & warnings").
std::string html_text(const std::string& element, const std::string& text);

}  // namespace trilens
