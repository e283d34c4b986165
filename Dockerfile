# Builds with the compiler that Cargo.toml's rust-version names; runs without shell, as nobody.
FROM rust:1.95-slim-bookworm AS build
WORKDIR /src
COPY . .
ARG RASTERD_COMMIT
ENV RASTERD_COMMIT=${RASTERD_COMMIT}
RUN cargo build --release --locked --bin rasterd

FROM gcr.io/distroless/cc-debian12:nonroot
COPY --from=build /src/target/release/rasterd /usr/local/bin/rasterd
ENV RASTERD_LISTEN=0.0.0.0:8080
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=4s --start-period=5s CMD ["rasterd", "healthcheck"]
ENTRYPOINT ["rasterd"]
