#pragma once

namespace mindahl::loop {

/// One of the two channels of a loop.
enum class Channel { kDisplacement, kForce };

/// The one that answers where the other is imposed.
[[nodiscard]] constexpr Channel Other(Channel channel) {
  return channel == Channel::kForce ? Channel::kDisplacement : Channel::kForce;
}

}  // namespace mindahl::loop
