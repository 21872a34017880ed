"""The only place that knows a compiler: traces equations, emits kernels, keeps them in the user's cache folder."""
