//! A table whose rows are the fields of a structure.

/// Makes a structure over a number, and the rows that describe its fields, in their order.
macro_rules! table {
    (
        $(#[$doc:meta])* $name:ident, $row:ty, $rows:ident;
        $($field:ident: $content:expr,)*
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub(super) struct $name<T> {
            $(pub(super) $field: T,)*
        }

        /// What its fields are, in their order.
        pub(super) static $rows: [$row; <$name<()>>::LEN] = [$($content,)*];

        impl $name<()> {
            /// How many fields it has.
            pub(super) const LEN: usize = [$(stringify!($field),)*].len();
        }

        #[allow(dead_code, reason = "each table needs a part")]
        impl<T: Copy> $name<T> {
            /// From numbers in the order of the fields, which it uses up.
            #[inline(always)]
            pub(super) fn take(numbers: &mut impl FnMut() -> T) -> Self {
                Self { $($field: numbers(),)* }
            }

            /// The same of each field.
            #[inline(always)]
            pub(super) fn map<U>(&self, of: impl Fn(T) -> U) -> $name<U> {
                $name { $($field: of(self.$field),)* }
            }

            /// Each field, in their order.
            #[inline(always)]
            pub(super) fn give(&self, to: &mut impl FnMut(T)) {
                $(to(self.$field);)*
            }
        }
    };
}
pub(super) use table;
