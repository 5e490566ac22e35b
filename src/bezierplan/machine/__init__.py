"""What compiled kernels and jobs depend on, and where kernels lie."""
