fn main() -> std::process::ExitCode {
    pathspace::cli::main()
}
