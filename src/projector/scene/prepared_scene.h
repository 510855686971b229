// A scene made ready for drawing, as callers hold it.
#pragma once

#include <memory>

#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// A scene made ready for drawing: triangles in leaf order, and a tree over them.
/// Holds a reference to nothing: the scene is copied into structure-of-arrays form. The scene's points are
/// finite.
class PreparedScene {
  public:
    explicit PreparedScene(const TriangleScene& scene);
    ~PreparedScene();
    PreparedScene(PreparedScene&&) noexcept;
    PreparedScene& operator=(PreparedScene&&) noexcept;

    struct Data;
    const Data& data() const { return *data_; }

  private:
    std::unique_ptr<Data> data_;
};

}  // namespace trilens
