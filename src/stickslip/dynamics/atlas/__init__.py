"""The atlas: every motion that is found over a plane of two numbers, and the borders between them."""
