"""Closed-form influence of a loaded rectangle on a half-space, its mirror images, and fast convolution with both."""
