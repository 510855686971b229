// Names of what becomes of a glTF, and words for what is left out of it.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace trilens {

/// Distinct names: the second "a" becomes "a.2".
class DistinctNames {
  public:
    std::string take(const std::string& wanted) {
        std::string name = wanted;
        for (int k = 2; !names_.insert(name).second; ++k) name = wanted + "." + std::to_string(k);
        return name;
    }

  private:
    std::set<std::string> names_;
};

/// What scenes lack, told once each, with the first that has it.
class LeftOut {
  public:
    void note(const std::string& what, const std::string& whose) {
        auto& [first, count] = found_[what];
        if (count++ == 0) first = whose;
    }
    void tell(std::vector<std::string>& warnings) const {
        for (const auto& [what, who] : found_)
            warnings.push_back(what + " is not drawn (of '" + who.first + "'" +
                               (who.second > 1 ? " and " + std::to_string(who.second - 1) + " more" : "") +
                               ")");
    }

  private:
    std::map<std::string, std::pair<std::string, int>> found_;
};

}  // namespace trilens
