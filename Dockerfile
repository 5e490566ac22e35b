# The workflow and its locked environment in an image. `make image` builds it; then, with results on the host:
#   docker run --rm --user "$(id -u)" -v "$PWD/results:/bezierplan/results" bezierplan smoke --cores 2
FROM python:3.13-slim

# What `make` needs beside Python. Debian removes old versions, so a pinned one could soon not be installed.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends git make \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /bezierplan

# The environment is made anew only if a locked version changes.
COPY Makefile environment-build.txt environment.txt ./
RUN make .venv/ready

COPY . .
# Whoever runs it may write results and caches.
RUN touch .venv/ready \
    && mkdir -p results .cache .snakemake \
    && chmod -R a+rwX results .cache .snakemake

# Whoever runs it may be a user whom the image does not know, without a home and a name.
ENV PATH="/bezierplan/.venv/bin:$PATH" HOME=/tmp LOGNAME=bezierplan
ENTRYPOINT ["python", "-m", "snakemake"]
CMD ["--help"]
