#pragma once

namespace mindahl::loop {

/// One of the two channels of a loop.
enum class Channel { kDisplacement, kForce };

/// Returns the channel that responds where the other is imposed.
[[nodiscard]] constexpr Channel Other(Channel channel) {
  return channel == Channel::kForce ? Channel::kDisplacement : Channel::kForce;
}

}  // namespace mindahl::loop
